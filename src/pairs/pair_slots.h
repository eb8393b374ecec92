// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/copy_all.h"
#include "executor/row_slices.h"
#include "free_all.h"
#include "slot_pair.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace raycontact {

/// Whether so many of `slots` are in use that those who number by them should begin anew.
inline bool is_mostly_empty(std::size_t slots, std::size_t used) {
    return slots > 4 * used + 1024;
}

/// The open pairs. Each keeps its slot while it is open. Slots are reused, so memory follows the most pairs ever open
/// at once.
class PairSlots {
public:
    /// pairs: sorted, without duplicates. Calls closed(slot) for each pair that is gone, then opened(now, slot) for
    /// each new one, both in their order; then, on all threads, kept(old, now, n) for n pairs in a row that stay. old
    /// and now are places in the last list and in `pairs`. Returns false, without any call, if the pairs are the same
    /// as before.
    template <class Kept, class Opened, class Closed>
    bool match(Executor& executor, std::span<const SlotPair> pairs, Kept&& kept, Opened&& opened, Closed&& closed) {
        if (std::equal(pairs.begin(), pairs.end(), open_.begin(), open_.end())) return false;
        next_.resize(pairs.size());
        const std::size_t count = RowSlices{pairs.size(), slice_size}.count();
        if (slices_.size() < count) slices_.resize(count);
        executor.each(count, 1, [&](std::uint32_t s) { compare(pairs, s); });
        const std::span<const Slice> slices = std::span(slices_).first(count);
        for (const Slice& slice : slices)
            for (const std::size_t old : slice.closed) {
                closed(slots_[old]);
                free_.push_back(slots_[old]);
            }
        for (const Slice& slice : slices)
            for (const std::size_t now : slice.opened) opened(now, next_[now] = new_slot());
        executor.each(count, 1, [&](std::uint32_t s) {
            for (const Run& run : slices[s].kept) {
                std::copy_n(slots_.begin() + std::ptrdiff_t(run.old), run.count,
                            next_.begin() + std::ptrdiff_t(run.now));
                kept(run.old, run.now, run.count);
            }
        });
        slots_.swap(next_);
        copy_all(executor, pairs, open_);
        return true;
    }

    std::span<const SlotPair> pairs() const { return open_; }
    /// The slot of the i-th pair.
    std::uint32_t slot(std::size_t i) const { return slots_[i]; }
    /// All slots are below this.
    std::uint32_t end() const { return end_; }

    /// Gives the open pairs the lowest slots, and memory back. Calls moved(slot, i) for the i-th pair, which has slot i
    /// from then on.
    template <class Moved>
    void compact(Moved&& moved) {
        for (std::size_t i = 0; i < slots_.size(); ++i) {
            moved(slots_[i], i);
            slots_[i] = static_cast<std::uint32_t>(i);
        }
        end_ = static_cast<std::uint32_t>(slots_.size());
        free_all(next_, free_, slices_);
        open_.shrink_to_fit();
        slots_.shrink_to_fit();
    }

    void clear() { *this = {}; }

private:
    static constexpr std::size_t slice_size = 4096; // pairs
    struct Run {
        std::size_t old, now, count;
    };
    /// What became of pairs in a row.
    struct Slice {
        std::vector<Run> kept;
        std::vector<std::size_t> opened, closed; ///< places among the new, the old
    };

    // The s-th slice of `pairs`, and the old ones from its first pair up to that of the next slice.
    void compare(std::span<const SlotPair> pairs, std::size_t s) {
        Slice& slice = slices_[s];
        slice.kept.clear();
        slice.opened.clear();
        slice.closed.clear();
        std::size_t now = s * slice_size;
        const std::size_t end = std::min(pairs.size(), now + slice_size);
        const auto before = beside(open_, now, end, pairs.size(), [&](std::size_t i) { return pairs[i]; });
        auto old = static_cast<std::size_t>(before.begin() - open_.begin());
        const std::size_t old_end = old + before.size();
        while (now < end || old < old_end) {
            // Most pairs stay, in runs.
            const std::size_t most = std::min(end - now, old_end - old);
            std::size_t same = 0;
            while (same < most && pairs[now + same] == open_[old + same]) ++same;
            if (same > 0) slice.kept.push_back({old, now, same});
            now += same;
            old += same;
            if (old < old_end && (now == end || open_[old] < pairs[now]))
                slice.closed.push_back(old++);
            else if (now < end && (old == old_end || pairs[now] < open_[old]))
                slice.opened.push_back(now++);
        }
    }

    std::uint32_t new_slot() {
        if (free_.empty()) return end_++;
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        return slot;
    }

    std::vector<Slice> slices_; ///< of match()
    std::vector<SlotPair> open_;
    std::vector<std::uint32_t> slots_, next_, free_;
    std::uint32_t end_ = 0;
};

} // namespace raycontact
