// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>

#include <cstdint>

namespace raycontact::bench {

/// Few, large and fast: knots, gears and bumpy tori of 1 m run along circles of 1.1 m about one middle, each in a plane
/// of its own, and turn, through each other: what moves is set, so that nothing is pushed apart. 60 steps a second.
struct SwarmOptions {
    std::uint32_t bodies = 6;
    std::uint32_t steps = 120;
    std::uint32_t triangles = 20000; ///< of each body: 10 000 vertices
    double speed = 4;                ///< m/s along the circles: 7 % of the size a step
    double turns = 0.5;              ///< a second, about an axis of its own
    std::uint64_t seed = 1;
};

Work swarm_work(const SwarmOptions& options);

} // namespace raycontact::bench
