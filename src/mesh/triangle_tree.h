// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "executor/executor.h"
#include "mesh/adjacency.h"

#include <span>
#include <vector>

namespace raycontact {

/// A sixteen-wide tree over blocks of sixteen triangles, in float32.
struct TriangleTree {
    std::vector<kernels::TriangleBlock> triangle_blocks;
    std::vector<kernels::Node> nodes;
};

/// What a tree is built over, and how.
struct TreePlan {
    std::span<const kernels::Packed3> points;
    std::span<const Triangle> triangles;
    std::span<const std::uint32_t> chosen; ///< of the triangles
    double grow;                           ///< is added around every box, metres
    bool balanced;                         ///< split in the middle: quicker to build, slower to search, never deep
    int levels;                            ///< at most
};

/// Of any tree; a balanced one over the largest mesh has seven. Those of shapes have no more than NODE_LEVELS.
constexpr int most_tree_levels = 8;

/// Split by the surface area heuristic at multiples of a block, so that blocks are full, or balanced. Depends on
/// nothing but the plan. False if it comes out too deep.
[[nodiscard]] bool build_tree(TriangleTree& tree, const TreePlan& plan, Executor& executor);

} // namespace raycontact
