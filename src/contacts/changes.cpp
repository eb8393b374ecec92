// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

namespace raycontact {

namespace {

// All of a feature that its key tells.
ContactFeature feature_of(std::uint64_t key) {
    constexpr std::uint64_t edge = (1u << 31) - 1;
    const std::uint64_t tag = key >> 62;
    if (tag == 2)
        return {FeatureKind::edges, Side::a, static_cast<std::uint32_t>(key >> 31 & edge),
                static_cast<std::uint32_t>(key & edge)};
    const bool inside = tag == 3;
    const bool of_a = inside ? (key >> 32 & 1) == 0 : tag == 0;
    const auto vertex = static_cast<std::uint32_t>(key);
    constexpr std::uint32_t none = ContactFeature::no_index;
    return {inside ? FeatureKind::inside : FeatureKind::vertex, of_a ? Side::a : Side::b, of_a ? vertex : none,
            of_a ? none : vertex};
}

} // namespace

void Changes::mark(std::span<Contact> contacts) {
    lost_.clear();
    new_count_ = 0;
    std::size_t old = 0;
    const auto lose = [this](std::size_t i) {
        if (touched_[i] != 0) lost_.push_back({previous_[i].body_a, previous_[i].body_b, feature_of(previous_[i].key)});
    };
    for (Contact& contact : contacts) {
        const ContactOrder order = order_of(contact);
        const bool touches = !contact.is_speculative();
        for (; old < previous_.size() && previous_[old].order() < order; ++old) lose(old);
        const bool known = old < previous_.size() && previous_[old].order() == order;
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
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        previous_[i] = {contacts[i].body_a, contacts[i].body_b, contacts[i].key()};
        touched_[i] = contacts[i].is_speculative() ? 0 : 1;
    }
}

} // namespace raycontact
