// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"
#include "mesh/triangle_tree.h"

#include <array>
#include <limits>

namespace raycontact {

/// The box of a child.
inline Box box_of(const kernels::Node& node, std::size_t lane) {
    const auto& b = node.bounds;
    return {{b[0][lane], b[1][lane], b[2][lane]}, {b[3][lane], b[4][lane], b[5][lane]}};
}

/// A number for each child of a node, to be filled in side by side.
template <class Number>
using Lanes = std::array<Number, NODE_LANES>;

/// Visits the blocks of a tree, those in near boxes first. away(node, lanes) fills in how far the children are, not
/// above what anything in them is; those as far as farthest(), which may shrink from visit to visit, are left out.
template <class Number, class Farthest, class Away, class Visit>
void nearest_first(const TriangleTree& tree, Farthest&& farthest, Away&& away, Visit&& visit) {
    struct Waiting {
        Number away;
        std::uint32_t child;
    };
    std::array<Waiting, most_tree_levels * NODE_LANES> waiting; // each level leaves at most fifteen
    std::size_t count = 0;
    waiting[count++] = {0, 0};
    while (count > 0) {
        const Waiting next = waiting[--count];
        if (next.away >= farthest()) continue;
        if ((next.child & LEAF) != 0) {
            visit(tree.triangle_blocks[next.child & ~LEAF]);
            continue;
        }
        const kernels::Node& node = tree.nodes[next.child];
        const Number most = farthest();
        Lanes<Number> lanes;
        away(node, lanes);
        const std::size_t first = count;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            if (!(lanes[lane] < most) || node.child[lane] == NONE) continue;
            std::size_t at = count++; // the nearest last, so that it is next
            for (; at > first && waiting[at - 1].away < lanes[lane]; --at) waiting[at] = waiting[at - 1];
            waiting[at] = {lanes[lane], node.child[lane]};
        }
    }
}

/// Visits the blocks in boxes that meets(box) until visit(block) returns false.
template <class Meets, class Visit>
void visit_blocks(const TriangleTree& tree, Meets&& meets, Visit&& visit) {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    bool goes_on = true;
    nearest_first<float>(
        tree, [&] { return goes_on ? infinite : 0; },
        [&](const kernels::Node& node, Lanes<float>& lanes) {
            for (std::size_t lane = 0; lane < NODE_LANES; ++lane)
                lanes[lane] = meets(box_of(node, lane)) ? 0 : infinite;
        },
        [&](const kernels::TriangleBlock& block) { goes_on = goes_on && visit(block); });
}

} // namespace raycontact
