// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/pair_table.h"
#include "pairs/update.h"
#include "rays/watched_pair.h"

namespace raycontact {

using WatchedPairs = PairTable<WatchedPair, Slack>;

/// Finds which directions of which pairs are due in a step, in the order of the pairs: by slices of the pairs, each on
/// one thread.
class WakeUp {
public:
    struct Slice {
        std::vector<Due> due;
        std::vector<kernels::DirectedPair> places; ///< of due
        std::vector<std::uint32_t> stale;          ///< indices of due: those that need a new list
        std::vector<std::uint32_t> fast;           ///< places of pairs that are too fast to be watched
        std::size_t first = 0;                     ///< place of its first due among all
        std::size_t segment_first = 0;             ///< place of its first segment among all
        std::uint64_t blocks = 0;                  ///< vertex blocks tested
    };

    void run(const Update& update, WatchedPairs& table);
    std::span<Slice> slices() { return std::span(slices_).first(slice_count_); }
    std::span<const Slice> slices() const { return std::span(slices_).first(slice_count_); }
    /// Calls work(slice) for each slice, on all threads.
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

    std::vector<Slice> slices_; ///< never shrinks
    std::uint32_t slice_count_ = 0;
};

} // namespace raycontact
