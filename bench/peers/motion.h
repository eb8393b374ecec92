// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>

#include <cstdint>
#include <memory>
#include <string>

// Works whose motion is set, not simulated. No libm in the poses: the same bits from every compiler.
namespace raycontact::bench {

struct ApproachOptions {
    std::uint32_t pairs = 32, steps = 100;
    double clearance = 0.10; ///< metres between the first pose and the one where they touch; meshes are 1 m
    double depth = 0.06;     ///< metres pushed in beyond that
};

/// Pairs of one mesh that start apart, come together, overlap and turn slowly all the while; each pair alone in its
/// cell of a grid.
Work approaching_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                       const ApproachOptions& options);

/// Pairs of one mesh of 1 m that roll over each other and keep, step by step, about the same number of contacts: the
/// finer the mesh, the less deep they are. So only one thing changes from work to work.
struct RollingOptions {
    std::uint32_t pairs = 16, steps = 40;
    std::uint32_t contacts = 6;  ///< of each pair, in every step; nearly, since one distance may add several
    double displacement = 0.005; ///< a step, as a part of the size, the median of Pace; 0: nothing moves
};

Work rolling_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                   const RollingOptions& options);

} // namespace raycontact::bench
