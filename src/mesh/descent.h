// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "interruption.h"
#include "mesh/measure.h"
#include "mesh/triangle_tree.h"

#include <raycontact/contact.h>

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

/// What a descent has still to visit, of each level the nearest last, so that it is next. Holds `Room` items at most:
/// each level leaves fifteen.
template <class Number, class Item, std::size_t Room>
class NearestLast {
public:
    struct Waiting {
        Number away;
        Item item;
    };

    explicit NearestLast(const Item& root) { waiting_[count_++] = {0, root}; }
    bool is_empty() const { return count_ == 0; }
    Waiting take() { return waiting_[--count_]; }

    /// Adds the children of a node that are nearer than `most`: item_of(lane) for each.
    template <class ItemOf>
    void add(const kernels::Node& node, const Lanes<Number>& lanes, Number most, ItemOf&& item_of) {
        const std::size_t first = count_;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            if (!(lanes[lane] < most) || node.child[lane] == NONE) continue;
            std::size_t at = count_++;
            for (; at > first && waiting_[at - 1].away < lanes[lane]; --at) waiting_[at] = waiting_[at - 1];
            waiting_[at] = {lanes[lane], item_of(lane)};
        }
    }

private:
    std::array<Waiting, Room> waiting_;
    std::size_t count_ = 0;
};

/// Visits the blocks of a tree, those in near boxes first. away(node, lanes) fills in how far the children are, not
/// above what anything in them is; those as far as farthest(), which may shrink from visit to visit, are left out.
template <class Number, class Farthest, class Away, class Visit>
void nearest_first(const TriangleTree& tree, Farthest&& farthest, Away&& away, Visit&& visit) {
    NearestLast<Number, std::uint32_t, most_tree_levels * NODE_LANES> waiting(0);
    const InterruptionCheck check;
    while (!waiting.is_empty()) {
        check();
        const auto next = waiting.take();
        if (next.away >= farthest()) continue;
        if ((next.item & LEAF) != 0) {
            visit(tree.triangle_blocks[next.item & ~LEAF]);
            continue;
        }
        const kernels::Node& node = tree.nodes[next.item];
        const Number most = farthest();
        Lanes<Number> lanes;
        away(node, lanes);
        waiting.add(node, lanes, most, [&](std::size_t lane) { return node.child[lane]; });
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

/// A child of a node, or the root: a node's number or LEAF | a block's, and the place of its box, or NONE.
struct Branch {
    std::uint32_t child, at;
};

/// The box of a branch.
inline Box box_of(const TriangleTree& tree, const Branch& branch) {
    if (branch.at != NONE) return box_of(tree.nodes[branch.at / NODE_LANES], branch.at % NODE_LANES);
    Box box = box_of(tree.nodes[0], 0);
    for (std::size_t lane = 1; lane < NODE_LANES; ++lane)
        if (tree.nodes[0].child[lane] != NONE) box.add(box_of(tree.nodes[0], lane));
    return box;
}

/// Visits the pairs of a block of one tree and a block of another, those in near boxes first. away(side, node, box,
/// lanes) fills in how far the children of a node of the tree `side` are from a box of the other tree, each in the
/// frame of its own tree; not above what anything in them is. Those as far as farthest(), which may shrink from visit
/// to visit, are left out. Of two nodes the one with the larger box is opened.
template <class Number, class Farthest, class Away, class Visit>
void nearest_pairs_first(const TriangleTree& a, const TriangleTree& b, Farthest&& farthest, Away&& away,
                         Visit&& visit) {
    struct Branches {
        Branch a, b;
    };
    const auto size_of = [](const Box& box) {
        const Vec3 extent = box.high - box.low;
        return extent.x + extent.y + extent.z;
    };
    NearestLast<Number, Branches, 2 * most_tree_levels * NODE_LANES> waiting({{0, NONE}, {0, NONE}});
    const InterruptionCheck check;
    while (!waiting.is_empty()) {
        check();
        const auto next = waiting.take();
        if (next.away >= farthest()) continue;
        const Branch &in_a = next.item.a, &in_b = next.item.b;
        const bool a_is_leaf = (in_a.child & LEAF) != 0, b_is_leaf = (in_b.child & LEAF) != 0;
        if (a_is_leaf && b_is_leaf) {
            visit(a.triangle_blocks[in_a.child & ~LEAF], b.triangle_blocks[in_b.child & ~LEAF]);
            continue;
        }
        const Box box_a = box_of(a, in_a), box_b = box_of(b, in_b);
        const bool opens_a = b_is_leaf || (!a_is_leaf && size_of(box_a) >= size_of(box_b));
        const std::uint32_t opened = opens_a ? in_a.child : in_b.child;
        const kernels::Node& node = (opens_a ? a : b).nodes[opened];
        const Number most = farthest();
        Lanes<Number> lanes;
        away(opens_a ? Side::a : Side::b, node, opens_a ? box_b : box_a, lanes);
        waiting.add(node, lanes, most, [&](std::size_t lane) {
            const Branch child{node.child[lane], static_cast<std::uint32_t>(opened * NODE_LANES + lane)};
            return opens_a ? Branches{child, in_b} : Branches{in_a, child};
        });
    }
}

} // namespace raycontact
