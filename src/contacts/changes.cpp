// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include "give_back.h"

#include <cstdint>
#include <tuple>

namespace raycontact {

namespace {

// What contacts are sorted by, in three words.
using Order = std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>;

template <class Key>
Order order_of(const Key& key) {
    const std::uint64_t source =
        static_cast<std::uint64_t>(key.vertex_body) << 8 | static_cast<std::uint8_t>(key.feature);
    return {std::uint64_t{key.body_a} << 32 | key.body_b, source << 32 | key.vertex, key.crossing};
}

} // namespace

void Changes::mark(std::span<Contact> contacts) {
    lost_.clear();
    new_count_ = 0;
    std::size_t old = 0;
    for (Contact& contact : contacts) {
        const Order order = order_of(contact);
        while (old < previous_.size() && order_of(previous_[old]) < order) lost_.push_back(previous_[old++]);
        contact.is_new = old == previous_.size() || order_of(previous_[old]) != order;
        if (contact.is_new)
            ++new_count_;
        else
            ++old;
    }
    lost_.insert(lost_.end(), previous_.begin() + static_cast<std::ptrdiff_t>(old), previous_.end());
    previous_.resize(contacts.size());
    give_back(previous_);
    give_back(lost_);
    for (std::size_t i = 0; i < contacts.size(); ++i)
        previous_[i] = {contacts[i].body_a,  contacts[i].body_b,   contacts[i].vertex_body,
                        contacts[i].feature, contacts[i].crossing, contacts[i].vertex};
}

} // namespace raycontact
