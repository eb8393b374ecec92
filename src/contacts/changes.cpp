// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include "executor/row_slices.h"

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

void Changes::Sums::add(const Sums& other) {
    fresh += other.fresh;
    speculative += other.speculative;
    ray_length += other.ray_length;
    depth_max = std::max(depth_max, other.depth_max);
}

// The contacts from the first on, with those of the last step that are of the same pairs, or of pairs that are gone.
void Changes::compare(std::size_t old, std::size_t old_end, std::span<Contact> contacts, std::size_t first,
                      Slice& slice) {
    const auto lose = [&](std::size_t i) {
        if (touched_[i] != 0)
            slice.lost.push_back({previous_[i].body_a, previous_[i].body_b, feature_of(previous_[i].key)});
    };
    for (Contact& contact : contacts) {
        const Known own{contact.body_a, contact.body_b, contact.key()};
        const bool touches = !contact.is_speculative();
        for (; old < old_end && previous_[old].order() < own.order(); ++old) lose(old);
        const bool known = old < old_end && previous_[old].order() == own.order();
        contact.is_new = !known || (touches && touched_[old] == 0);
        if (known && !touches) lose(old);
        if (known) ++old;
        next_[first] = own;
        next_touched_[first++] = touches ? 1 : 0;
        slice.sums.add({std::uint64_t{touches && contact.is_new}, std::uint64_t{!touches},
                        touches ? double(contact.ray_length) : 0, double(contact.depth)});
    }
    for (; old < old_end; ++old) lose(old);
}

void Changes::mark(Executor& executor, std::span<Contact> contacts) {
    const RowSlices slices{contacts.size()};
    next_.resize(contacts.size());
    next_touched_.resize(contacts.size());
    if (slices_.size() < slices.count()) slices_.resize(slices.count());
    const std::span<Slice> all = std::span(slices_).first(slices.count());
    for (Slice& slice : all) {
        slice.lost.clear();
        slice.sums = {};
    }
    const auto pair_at = [&](std::size_t i) { return order_of(contacts[i]).first; };
    const auto pair_of_known = [](const Known& known) { return known.order().first; };
    slices.each(
        executor, [&](std::size_t i) { return pair_at(i) == pair_at(i - 1); },
        [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
            const auto old = beside(previous_, begin, end, contacts.size(), pair_at, pair_of_known);
            const auto first = static_cast<std::size_t>(old.begin() - previous_.begin());
            compare(first, first + old.size(), contacts.subspan(begin, end - begin), begin, slices_[slice]);
        });
    lost_.clear();
    sums_ = {};
    for (const Slice& slice : all) {
        lost_.insert(lost_.end(), slice.lost.begin(), slice.lost.end());
        sums_.add(slice.sums);
    }
    previous_.swap(next_);
    touched_.swap(next_touched_);
}

} // namespace raycontact
