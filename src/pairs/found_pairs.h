// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/row_slices.h"
#include "pairs/pair_slots.h"
#include "pairs/pair_sorter.h"

#include <algorithm>
#include <span>
#include <vector>

namespace raycontact {

/// The pairs of which a device found something, in order. A device answers by slot, for all pairs that are open.
class FoundPairs {
public:
    void clear() { slice_count_ = 0; }
    /// Those of `found`: directed_of() of one is 2 x slot, + 1 for vertices of the second body. What is of one slot
    /// lies in a row.
    template <class T, class DirectedOf>
    void add(Executor& executor, const PairSlots& open, std::span<const T> found, DirectedOf&& directed_of) {
        const RowSlices slices{found.size()};
        const std::size_t first = slice_count_;
        slice_count_ += slices.count();
        if (slices_.size() < slice_count_) slices_.resize(slice_count_);
        for (std::size_t i = first; i < slice_count_; ++i) slices_[i].clear();
        const auto slot_at = [&](std::size_t i) { return directed_of(found[i]) / 2; };
        slices.each(
            executor, [&](std::size_t i) { return slot_at(i) == slot_at(i - 1); },
            [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    if (i == begin || slot_at(i) != slot_at(i - 1))
                        slices_[first + slice].push_back({open[slot_at(i)], slot_at(i)});
            });
    }
    /// After all add().
    void list(Executor& executor, const PairSlots& open, std::size_t bodies) {
        lists_.assign(slices_.begin(), slices_.begin() + std::ptrdiff_t(slice_count_));
        sorter_.run(executor, bodies, lists_, sorted_);
        sorted_.erase(std::unique(sorted_.begin(), sorted_.end()), sorted_.end());
        list_.assign(executor, sorted_);
        set_places(executor, open, list_.slots);
    }
    const PairList& pairs() const { return list_; }

    /// The places of some pairs in their list.
    void set_places(Executor& executor, const PairSlots& open, std::span<const std::uint32_t> slots) {
        places_.resize(open.end());
        executor.each(slots.size(), 8192, [&](std::uint32_t i) { places_[slots[i]] = i; });
    }
    /// The directed index by these places.
    std::uint32_t directed(std::uint32_t by_slot) const { return 2 * places_[by_slot / 2] + by_slot % 2; }

private:
    std::vector<std::vector<OpenPair>> slices_; ///< of what was added
    std::size_t slice_count_ = 0;
    std::vector<std::span<const OpenPair>> lists_;
    std::vector<OpenPair> sorted_;
    PairSorter<OpenPair> sorter_;
    PairList list_;
    std::vector<std::uint32_t> places_; ///< by slot; of pairs that are not listed they mean nothing
};

} // namespace raycontact
