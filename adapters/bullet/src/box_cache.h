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
        const Turn turn(busy_);
        if (turn.mine && find(transform, low, high)) return;
        make(low, high);
        made_.fetch_add(1, std::memory_order_relaxed);
        if (turn.mine) put(transform, low, high);
    }
    /// How many boxes were made.
    std::uint64_t made() const { return made_.load(std::memory_order_relaxed); }

private:
    struct Turn {
        explicit Turn(std::atomic_flag& flag) : busy(flag), mine(!flag.test_and_set(std::memory_order_acquire)) {}
        ~Turn() { // also where memory ends
            if (mine) busy.clear(std::memory_order_release);
        }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        std::atomic_flag& busy;
        const bool mine;
    };
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
