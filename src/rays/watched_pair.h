// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "pairs/displacement.h"

#include <array>
#include <cstdint>

namespace raycontact {

/// The rays that one direction of a pair had in a step. held: `Held` data was stored for them.
struct WatchedRays {
    std::uint32_t first = 0, count = 0;
    bool held = false;
};

/// What the certified method keeps for one direction of a pair: the vertex blocks that it watches, and a clock that
/// counts metres moved since the pair's reference pose.
struct Watched {
    double clock = 0;   ///< at the reference pose
    double wake = 0;    ///< no block need be looked at before the clock reaches this
    double expiry = -1; ///< a new list of blocks is due when the clock reaches this; below 0: at once
    std::uint32_t first = 0, count = 0, capacity = 0; ///< the list
    WatchedRays rays;
};

/// The near edges that are kept of a pair: a range of EdgeLists.
struct KeptEdges {
    std::uint32_t first = 0, capacity = 0;
    std::array<std::uint32_t, 2> counts{}; ///< of the first body, of the second
    bool all = false;                      ///< short ones, too (docs/edges.md)
    std::uint32_t count() const { return counts[0] + counts[1]; }
};

struct WatchedPair {
    Watched directions[2];
    KeptEdges edges;
    double speed = 0; ///< metres a step, smoothed; decides how far a list reaches
    PairPlace reference;
    std::uint32_t as_standard = 0; ///< steps for which it is still left to `standard`
};

/// What is read for every pair in every step.
struct Slack {
    double metres = -1; ///< that the pair may move, by the cheap bound, before the exact one is computed
    double edges = -1;  ///< that it may move before its near edges are sought anew
    bool open = false;  ///< it has lists
    bool casts = false; ///< it has rays, to be decided in every step
    bool apart = false; ///< as AskedPair's, while its near edges last
};

/// A direction of a pair that has work in this step: rays to decide, blocks to test, or a list to make.
struct Due {
    Watched* own;
    std::uint32_t directed;   ///< directed index of the pair
    float now;                ///< the clock
    float margin, radius;     ///< metres: of rounding; of tubes to seek, 0: none
    kernels::uint tests_caps; ///< 1: its rays test caps
    double longest;           ///< metres that a new list may last
};

/// Near edges last while the pair moves this share of the margin by which they were sought.
inline constexpr double edge_share = 0.998;
inline constexpr double never = 1e300; ///< metres

/// A pair whose near edges may be sought in this step.
struct DueEdges {
    std::uint32_t pair;  ///< its place
    float margin, ahead; ///< metres beyond what is needed that they are sought; beyond that, that bounds are
    bool due;            ///< else they are sought only if short ones are missing
};

} // namespace raycontact
