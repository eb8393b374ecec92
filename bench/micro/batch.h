// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/sweep_and_prune.h"
#include "pairs/ordered_pairs.h"

#include <raycontact/scene.h>

#include <string>
#include <vector>

namespace raycontact::bench {

/// The fixed input of the micro-benchmarks and of the instruction counts: one shape, many overlapping pairs of it.
/// Equal arguments give equal bits on every machine, so that a count of instructions can be compared with an old one.
struct Batch {
    std::string name; ///< "knot_902"
    Mesh mesh;
    std::shared_ptr<const Shape> shape;
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs; ///< bodies 2 i and 2 i + 1, at random: turned anyhow, middles up to 0.35 box diagonals
                                 ///< apart along each axis
    std::vector<kernels::OrderedPair> ordered;
    std::vector<kernels::OrderedPair> moved; ///< the same a step later: each body up to 0.3 % of the diagonal along
                                             ///< each axis and a third of a degree about it
};

/// A procedural knot of so many triangles, 1 m across.
Batch make_batch(std::uint32_t triangles, std::size_t pairs);

/// Unit boxes scattered so that each meets about three others.
std::vector<WorldBox> make_boxes(std::size_t count);

} // namespace raycontact::bench
