// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raycontact::bullet {

/// The boxes of one mesh at the transforms that it was last asked for. Bullet asks for the box of every body in every
/// step, asleep or not, each time by the body's own transform: its address says which box may do, its value whether it
/// does. On any thread: one that finds another at work makes its box itself.
class BoxCache {
public:
    /// make(low, high) is called unless the box is known.
    template <class Make>
    void get(const btTransform& transform, btVector3& low, btVector3& high, Make&& make) {
        const bool mine = !busy_.test_and_set(std::memory_order_acquire);
        if (!mine || !find(transform, low, high)) {
            make(low, high);
            made_.fetch_add(1, std::memory_order_relaxed);
            if (mine) put(transform, low, high);
        }
        if (mine) busy_.clear(std::memory_order_release);
    }
    /// How many boxes were made.
    std::uint64_t made() const { return made_.load(std::memory_order_relaxed); }

private:
    struct Entry {
        const btTransform* owner = nullptr; ///< only compared: it may be gone
        btTransform transform;
        btVector3 low, high;
    };
    static constexpr std::size_t ways = 4, first_sets = 4, most_sets = 1 << 14; ///< at most 8 MiB

    Entry* set_of(const btTransform& transform);
    bool find(const btTransform& transform, btVector3& low, btVector3& high);
    void put(const btTransform& transform, const btVector3& low, const btVector3& high);

    std::vector<Entry> entries_; ///< sets of `ways`; a power of two of sets
    std::size_t evicted_ = 0;    ///< since it grew
    std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
    std::atomic<std::uint64_t> made_ = 0;
};

} // namespace raycontact::bullet
