// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>

#include <cstdint>
#include <memory>
#include <string>

namespace raycontact::bench {

struct ApproachOptions {
    std::uint32_t pairs = 32, steps = 100;
    double clearance = 0.10; ///< metres between the first pose and the one where they touch; meshes are 1 m
    double depth = 0.06;     ///< metres pushed in beyond that
};

/// Pairs of one mesh that start apart, come together, overlap and turn slowly all the while; each pair alone in its
/// cell of a grid. No libm in the poses: the same bits from every compiler.
Work approaching_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                       const ApproachOptions& options);

} // namespace raycontact::bench
