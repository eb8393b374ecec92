// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/sweep_and_prune.h"
#include "pairs/directed_pairs.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace raycontact::bench {

/// The fixed input of the instruction counts: one shape, many overlapping pairs of it, some steps.
/// Equal arguments give equal bits on every machine, so that a count of instructions can be compared with an old one.
struct Batch {
    Mesh mesh;
    std::shared_ptr<const Shape> shape;
    std::vector<SlotPair> pairs; ///< bodies 2 i and 2 i + 1, at random: turned anyhow, middles up to 0.35 box diagonals
                                 ///< apart along each axis
    /// The bodies in each step. A quarter of the pairs creeps, and each further quarter moves four times as far: from
    /// 0.01 % of the diagonal a step along each axis and a hundredth of a degree, at most, to 0.64 %.
    std::vector<std::vector<PlacedBody>> steps;
};

/// A procedural knot of so many triangles, 1 m across.
Batch make_batch(std::uint32_t triangles, std::size_t pairs, std::size_t steps);

/// Unit boxes scattered so that each meets about three others.
std::vector<WorldBox> make_boxes(std::size_t count);

} // namespace raycontact::bench
