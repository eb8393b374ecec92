// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/pair_table.h"
#include "pairs/update.h"
#include "rays/watched_pair.h"

namespace raycontact {

using WatchedPairs = PairTable<WatchedPair, Slack>;

/// Which directions of which pairs are due in a step, in the order of the pairs. Found by slices of the pairs, each by
/// one thread.
class WakeUp {
public:
    struct Slice {
        std::vector<Due> due;
        std::vector<kernels::OrderedPair> places; ///< of due
        std::vector<std::uint32_t> stale;         ///< of due: need a new list
        std::vector<std::uint32_t> fast;          ///< pairs: too fast to be watched
        std::size_t first = 0;                    ///< of its due among all
        std::size_t segment_first = 0;            ///< of theirs
        std::uint64_t blocks = 0;                 ///< looked at
    };

    void run(const Update& update, WatchedPairs& table);
    std::span<Slice> slices() { return std::span(slices_).first(slice_count_); }
    std::span<const Slice> slices() const { return std::span(slices_).first(slice_count_); }
    /// work(slice) for each slice, some at a time.
    template <class Work>
    void each_slice(Executor& executor, Work&& work) {
        executor.run(slice_count_, 8, [&](std::uint32_t begin, std::uint32_t end) {
            for (Slice& slice : slices().subspan(begin, end - begin)) work(slice);
        });
    }

private:
    static void wake_slice(const Update& update, WatchedPairs& table, std::uint32_t begin, std::uint32_t end,
                           Slice& slice);
    static void wake_pair(const Update& update, WatchedPairs& table, std::uint32_t i, double speed, Slice& slice);

    std::vector<Slice> slices_; ///< only ever more
    std::uint32_t slice_count_ = 0;
};

} // namespace raycontact
