// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include "give_back.h"

namespace raycontact {

namespace {

LostContact key_of(const Contact& c) {
    return {c.body_a, c.body_b, c.vertex_body, c.feature, c.vertex, c.other()};
}

} // namespace

ContactOrder order_of(const LostContact& key) {
    const std::uint64_t source =
        static_cast<std::uint64_t>(key.feature) << 8 | static_cast<std::uint8_t>(key.vertex_body);
    return {std::uint64_t{key.body_a} << 32 | key.body_b, source << 32 | key.vertex, key.other};
}

ContactOrder order_of(const Contact& contact) {
    return order_of(key_of(contact));
}

void Changes::mark(std::span<Contact> contacts) {
    lost_.clear();
    new_count_ = 0;
    std::size_t old = 0;
    const auto lose = [this](std::size_t i) {
        if (touched_[i] != 0) lost_.push_back(previous_[i]);
    };
    for (Contact& contact : contacts) {
        const ContactOrder order = order_of(contact);
        const bool touches = !is_speculative(contact);
        for (; old < previous_.size() && order_of(previous_[old]) < order; ++old) lose(old);
        const bool known = old < previous_.size() && order_of(previous_[old]) == order;
        contact.is_new = !known || (touches && touched_[old] == 0);
        if (known && !touches) lose(old);
        if (known) ++old;
        if (touches && contact.is_new) ++new_count_;
    }
    for (; old < previous_.size(); ++old) lose(old);
    previous_.reserve(contacts.size()); // either may throw: then both stay as they are
    touched_.reserve(contacts.size());
    previous_.resize(contacts.size());
    touched_.resize(contacts.size());
    give_back(previous_, touched_, lost_);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        previous_[i] = key_of(contacts[i]);
        touched_[i] = is_speculative(contacts[i]) ? 0 : 1;
    }
}

} // namespace raycontact
