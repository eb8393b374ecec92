// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include "executor/rows.h"

#include <algorithm>

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

void Changes::compare(std::span<const Known> previous, std::span<Contact> contacts, Slice& slice) const {
    const auto touched = [&](const Known& known) { return touched_[std::size_t(&known - previous_.data())] != 0; };
    const auto lose = [&](const Known& known) {
        if (touched(known)) slice.lost.push_back({known.body_a, known.body_b, feature_of(known.key)});
    };
    auto old = previous.begin();
    for (Contact& contact : contacts) {
        const ContactOrder order = order_of(contact);
        const bool touches = !contact.is_speculative();
        for (; old != previous.end() && old->order() < order; ++old) lose(*old);
        const bool known = old != previous.end() && old->order() == order;
        contact.is_new = !known || (touches && !touched(*old));
        if (known && !touches) lose(*old);
        if (known) ++old;
        if (touches && contact.is_new) ++slice.new_count;
    }
    for (; old != previous.end(); ++old) lose(*old);
}

void Changes::mark(Executor& executor, std::span<Contact> contacts) {
    const RowSlices slices{contacts.size()};
    slices_.resize(std::max<std::size_t>(1, slices.count()));
    for (Slice& slice : slices_) slice.lost.clear(), slice.new_count = 0;
    const auto pair_at = [&](std::size_t i) { return order_of(contacts[i]).first; };
    // The old ones up to the first contact of a slice are an earlier one's.
    const auto old_at = [&](std::size_t i) {
        if (i == 0 || i == contacts.size()) return i == 0 ? previous_.begin() : previous_.end();
        return std::ranges::lower_bound(previous_, pair_at(i), {},
                                        [](const Known& known) { return known.order().first; });
    };
    if (contacts.empty()) compare(previous_, contacts, slices_.front());
    slices.each(
        executor, [&](std::size_t i) { return pair_at(i) == pair_at(i - 1); },
        [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
            compare({old_at(begin), old_at(end)}, contacts.subspan(begin, end - begin), slices_[slice]);
        });
    lost_.clear();
    new_count_ = 0;
    for (const Slice& slice : slices_) {
        lost_.insert(lost_.end(), slice.lost.begin(), slice.lost.end());
        new_count_ += slice.new_count;
    }
    previous_.reserve(contacts.size()); // either may throw: then both stay as they are
    touched_.reserve(contacts.size());
    previous_.resize(contacts.size());
    touched_.resize(contacts.size());
    executor.each(contacts.size(), 4096, [&](std::uint32_t i) {
        previous_[i] = {contacts[i].body_a, contacts[i].body_b, contacts[i].key()};
        touched_[i] = contacts[i].is_speculative() ? 0 : 1;
    });
}

} // namespace raycontact
