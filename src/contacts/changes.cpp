// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include <tuple>

namespace raycontact {

namespace {

template <class Key>
auto order_of(const Key& key) {
    return std::tuple(key.body_a, key.body_b, key.vertex_body, key.vertex);
}

} // namespace

void Changes::mark(std::span<Contact> contacts) {
    lost_.clear();
    new_count_ = 0;
    std::size_t old = 0;
    for (Contact& contact : contacts) {
        const auto order = order_of(contact);
        while (old < previous_.size() && order_of(previous_[old]) < order) lost_.push_back(previous_[old++]);
        contact.is_new = old == previous_.size() || order_of(previous_[old]) != order;
        if (contact.is_new)
            ++new_count_;
        else
            ++old;
    }
    lost_.insert(lost_.end(), previous_.begin() + static_cast<std::ptrdiff_t>(old), previous_.end());
    previous_.clear();
    for (const Contact& c : contacts) previous_.push_back({c.body_a, c.body_b, c.vertex_body, c.vertex});
}

} // namespace raycontact
