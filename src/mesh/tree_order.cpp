// SPDX-License-Identifier: Apache-2.0
#include "mesh/tree_order.h"

#include "mesh/tree_parts.h"

#include <algorithm>
#include <span>

namespace raycontact {

namespace {

using kernels::uint;

std::span<const uint> part(const std::vector<uint>& list, std::size_t i, std::size_t lanes) {
    return std::span(list).subspan(lanes * i, lanes);
}

/// The lanes in use, which come first; none if another one follows an empty one.
std::span<const uint> used(std::span<const uint> lanes) {
    const auto end = std::ranges::find(lanes, NONE);
    const bool empty_behind = std::all_of(end, lanes.end(), [](uint lane) { return lane == NONE; });
    return empty_behind ? std::span(lanes.begin(), end) : std::span<const uint>();
}

class Restorer {
public:
    Restorer(TriangleTree& tree, const TreePlan& plan, const TreeOrder& order)
        : tree_(tree), plan_(plan), order_(order) {}

    bool restore(Executor& executor) {
        const std::size_t blocks = order_.triangles.size() / TRIANGLE_LANES,
                          nodes = order_.children.size() / NODE_LANES;
        if (order_.triangles.size() % TRIANGLE_LANES != 0 || order_.children.size() % NODE_LANES != 0 || nodes == 0
            || blocks == 0 || blocks >= LEAF || !holds_each_once())
            return false;
        boxes_.resize(blocks);
        tree_.triangle_blocks.resize(blocks);
        executor.each(blocks, 64, [&](std::uint32_t i) { write_block(i); });
        tree_.nodes.resize(nodes);
        placed_.assign(blocks, 0);
        ItemBox box;
        return write_node(0, 1, box) && next_ == nodes && std::ranges::count(placed_, 0) == 0;
    }

private:
    // The chosen triangles, in rising order within each block.
    bool holds_each_once() const {
        std::vector<char> missing(plan_.triangles.size(), 0);
        for (const uint t : plan_.chosen) missing[t] = 1;
        std::size_t count = 0;
        for (std::size_t i = 0; TRIANGLE_LANES * i < order_.triangles.size(); ++i) {
            const auto own = used(part(order_.triangles, i, TRIANGLE_LANES));
            if (own.empty() || !std::ranges::is_sorted(own)) return false;
            for (const uint t : own) {
                if (t >= missing.size() || missing[t] == 0) return false;
                missing[t] = 0;
            }
            count += own.size();
        }
        return count == plan_.chosen.size();
    }

    void write_block(std::size_t i) {
        const auto triangles = part(order_.triangles, i, TRIANGLE_LANES);
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            write_lane(tree_.triangle_blocks[i], lane, plan_, triangles[lane]);
            if (triangles[lane] != NONE) boxes_[i].add(box_of_triangle(plan_, triangles[lane]));
        }
    }

    // Nodes are numbered as a walk from the root comes to them, so that no number but the next one is right.
    bool write_node(uint parent, int level, ItemBox& box) {
        if (level > plan_.levels || next_ == tree_.nodes.size()) return false;
        const uint id = next_++;
        const auto children = used(part(order_.children, id, NODE_LANES));
        if (children.empty()) return false;
        kernels::Node& node = tree_.nodes[id];
        node = {};
        node.parent = parent;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            const bool empty = lane >= children.size();
            node.child[lane] = empty ? NONE : children[lane];
            ItemBox own;
            if (!empty && !write_child(id, children[lane], level, own)) return false;
            write_box(node, lane, empty ? nullptr : &own, plan_.grow);
            if (!empty) box.add(own);
        }
        return true;
    }

    bool write_child(uint parent, uint child, int level, ItemBox& box) {
        if ((child & LEAF) == 0) return child == next_ && write_node(parent, level + 1, box);
        const uint block = child & ~LEAF;
        if (block >= placed_.size() || placed_[block] != 0) return false;
        placed_[block] = 1;
        box = boxes_[block];
        return true;
    }

    TriangleTree& tree_;
    const TreePlan& plan_;
    const TreeOrder& order_;
    std::vector<ItemBox> boxes_; ///< of blocks
    std::vector<char> placed_;   ///< blocks that a node has
    uint next_ = 0;              ///< node
};

} // namespace

TreeOrder order_of(const TriangleTree& tree) {
    TreeOrder order;
    order.triangles.reserve(TRIANGLE_LANES * tree.triangle_blocks.size());
    for (const auto& block : tree.triangle_blocks)
        order.triangles.insert(order.triangles.end(), block.triangle, block.triangle + TRIANGLE_LANES);
    order.children.reserve(NODE_LANES * tree.nodes.size());
    for (const auto& node : tree.nodes)
        order.children.insert(order.children.end(), node.child, node.child + NODE_LANES);
    return order;
}

bool restore_tree(TriangleTree& tree, const TreePlan& plan, const TreeOrder& order, Executor& executor) {
    return Restorer(tree, plan, order).restore(executor);
}

} // namespace raycontact
