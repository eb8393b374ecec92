// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "pairs/displacement.h"

#include <cstdint>

namespace raycontact {

/// The rays that one direction of a pair had in a step. held: what was found out about them is kept beside them.
struct WatchedRays {
    std::uint32_t first = 0, count = 0;
    bool held = false;
};

/// What the certified method keeps of one direction of a pair: the vertex blocks that it watches, and a clock that runs
/// in metres, from the pair's reference pose on.
struct Watched {
    double clock = 0;   ///< at the reference pose
    double wake = 0;    ///< no block need be looked at before the clock reaches this
    double expiry = -1; ///< a new list of blocks is due when the clock reaches this; below 0: at once
    std::uint32_t first = 0, count = 0, capacity = 0; ///< the list
    WatchedRays rays;
};

struct WatchedPair {
    Watched directions[2];
    double speed = 0; ///< metres a step, smoothed; decides how far a list reaches
    PairPlace reference;
};

/// What is asked of every pair in every step.
struct Slack {
    double metres = -1; ///< that the pair may move, by a cheap bound, before the exact one is asked
    bool open = false;  ///< it has lists
    bool casts = false; ///< it has rays, to be decided in each step in which it moves
};

/// A direction whose blocks are asked in this step.
struct Due {
    Watched* own = nullptr;
    std::uint32_t directed = 0;   ///< directed index of the pair
    bool stale = false;           ///< it needs a new list
    float now = 0;                ///< the clock
    float margin = 0, radius = 0; ///< of rounding; of tubes
    kernels::uint asks_caps = 0;  ///< of its rays
    double longest = 0;           ///< metres that a new list may last
};

} // namespace raycontact
