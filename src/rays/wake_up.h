// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/pair_table.h"
#include "pairs/update.h"
#include "rays/watched_pair.h"

#include <memory>

namespace raycontact {

using WatchedPairs = PairTable<WatchedPair, Slack>;

/// Finds which directions of which pairs are due in a step, in the order of the pairs: by slices of the pairs, each on
/// one thread.
class WakeUp {
public:
    /// A list in memory that has room for all that it can hold.
    template <class T>
    class List {
    public:
        List() = default;
        explicit List(T* first) : first_(first) {}
        T& add() { return first_[size_++]; }
        std::uint32_t size() const { return size_; }
        T& operator[](std::uint32_t i) const { return first_[i]; }
        T* begin() const { return first_; }
        T* end() const { return first_ + size_; }

    private:
        T* first_ = nullptr;
        std::uint32_t size_ = 0;
    };
    struct Slice {
        List<Due> due;
        List<kernels::DirectedPair> places; ///< of due
        List<std::uint32_t> stale;          ///< indices of due: those that need a new list
        List<std::uint32_t> as_standard;    ///< places of pairs that are left to `standard`
        List<DueEdges> edges;
        std::size_t first = 0;         ///< place of its first due among all
        std::size_t segment_first = 0; ///< place of its first segment among all
        std::uint64_t blocks = 0;      ///< vertex blocks tested
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

    /// After a step: frees memory that it hardly used.
    void give_back();

private:
    static constexpr std::uint32_t slice_size = 128; // pairs
    /// Of the lists of a slice. Not initialised, so that what no step has used takes no memory.
    struct Room {
        Due due[2 * slice_size];
        kernels::DirectedPair places[2 * slice_size];
        std::uint32_t stale[2 * slice_size], as_standard[slice_size];
        DueEdges edges[slice_size];
    };
    static void wake_slice(const Update& update, WatchedPairs& table, std::uint32_t begin, std::uint32_t end,
                           Slice& slice);
    static void wake_pair(const Update& update, WatchedPairs& table, std::uint32_t i, double speed, Slice& slice);

    std::unique_ptr<Room[]> rooms_;
    std::vector<Slice> slices_; ///< one for each room
    std::uint32_t slice_count_ = 0;
    std::size_t most_due_ = 0; ///< of a step since there are these rooms
};

} // namespace raycontact
