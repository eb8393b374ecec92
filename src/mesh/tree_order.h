// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/triangle_tree.h"

#include <cstdint>
#include <vector>

namespace raycontact {

/// What takes long to find of a tree: which triangles share a block, and which boxes a node. The boxes follow.
struct TreeOrder {
    std::vector<std::uint32_t> triangles; ///< of each block, TRIANGLE_LANES each; NONE of empty lanes
    std::vector<std::uint32_t> children;  ///< of each node, NODE_LANES each, as kernels::Node has them
};

TreeOrder order_of(const TriangleTree& tree);

/// The tree that had this order, bit for bit, if the plan is its own. False where it is no order of the plan's
/// triangles, whatever the numbers: then the tree must not be used.
[[nodiscard]] bool restore_tree(TriangleTree& tree, const TreePlan& plan, const TreeOrder& order, Executor& executor);

} // namespace raycontact
