// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_tree.h"

#include "executor/divide.h"
#include "mesh/tree_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raycontact {

namespace {

using kernels::uint;
constexpr std::size_t block_size = TRIANGLE_LANES;
constexpr float infinite = ItemBox::infinite;

struct Item {
    ItemBox box;
    std::array<float, 3> centre; // doubled: only its order matters
    uint triangle;
};

// Where to split items that are sorted along an axis.
struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    std::size_t left = 0; // so many on one side

    void improve(const Cut& other) {
        if (other.cost < cost) *this = other;
    }
};

// The cheapest way to cover a branch: by itself (of_left 0), or of_left parts for its left child, the rest for its
// right.
struct Way {
    float cost = 0;
    uint of_left = 0;
};
// With up to 1, 2, ... parts.
using Ways = std::array<Way, NODE_LANES>;

struct Branch {
    ItemBox box;
    std::size_t left = 0, right = 0; // 0: a leaf
    uint block = 0;                  // of a leaf
};

std::size_t blocks_of(std::size_t items) {
    return (items + block_size - 1) / block_size;
}

auto before(int axis) {
    return [axis](const Item& a, const Item& b) {
        return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.triangle < b.triangle;
    };
}

// Splits at the middle of the longest axis, at a multiple of a block: good enough if a sweep would cost too much. Adds
// the items to the box.
std::size_t split_longest(std::span<Item> items, ItemBox& box) {
    ItemBox centres;
    for (const Item& item : items) {
        box.add(item.box);
        centres.add({item.centre, item.centre});
    }
    int longest = 0;
    float size = -infinite;
    for (int axis = 0; axis < 3; ++axis) {
        if (centres.high[axis] - centres.low[axis] <= size) continue;
        size = centres.high[axis] - centres.low[axis];
        longest = axis;
    }
    const std::size_t left = block_size * (blocks_of(items.size()) / 2);
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(left), items.end(), before(longest));
    return left;
}

// The branches and blocks below one part of the items, numbered from 0. Parts are built side by side.
class Subtree {
public:
    std::vector<Branch> branches;
    std::vector<kernels::TriangleBlock> blocks;

    void build(const TreePlan& plan, std::span<Item> items) {
        plan_ = &plan;
        if (items.size() <= block_size) {
            add_leaf(items);
            return;
        }
        items_ = items;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // Sorted by copies of their keys: to look at each item would take twice as long.
            keys_.clear();
            for (uint i = 0; i < items.size(); ++i) keys_.push_back({items[i].centre[axis], items[i].triangle, i});
            std::sort(keys_.begin(), keys_.end());
            orders_[axis].clear();
            for (const Key& key : keys_) orders_[axis].push_back(key.item);
        }
        is_left_.resize(items.size());
        split_swept(0, items.size());
    }

private:
    struct Key {
        float centre;
        uint triangle, item;
        friend bool operator<(const Key& a, const Key& b) {
            return a.centre != b.centre ? a.centre < b.centre : a.triangle < b.triangle;
        }
    };

    // Of the items between two places of each order: the same ones in all three.
    std::size_t split_swept(std::size_t first, std::size_t last) {
        if (last - first <= block_size) {
            leaf_.clear();
            for (std::size_t i = first; i < last; ++i) leaf_.push_back(items_[orders_[0][i]]);
            return add_leaf(leaf_);
        }
        Cut best;
        ItemBox box;
        for (int axis = 0; axis < 3; ++axis) box = sweep(first, last, axis, best);
        const std::size_t id = branches.size();
        branches.emplace_back().box = box;
        const std::size_t middle = first + best.left;
        for (std::size_t i = first; i < last; ++i) is_left_[orders_[best.axis][i]] = i < middle;
        for (int axis = 0; axis < 3; ++axis)
            if (axis != best.axis) keep_order(orders_[axis], first, last);
        const std::size_t left = split_swept(first, middle), right = split_swept(middle, last);
        branches[id].left = left;
        branches[id].right = right;
        return id;
    }

    // Moves the left ones to the front; both keep their order.
    void keep_order(std::vector<uint>& order, std::size_t first, std::size_t last) {
        rest_.clear();
        std::size_t left = first;
        for (std::size_t i = first; i < last; ++i) {
            const uint item = order[i];
            if (is_left_[item])
                order[left++] = item;
            else
                rest_.push_back(item);
        }
        std::copy(rest_.begin(), rest_.end(), order.begin() + static_cast<std::ptrdiff_t>(left));
    }

    // Returns the box of all.
    ItemBox sweep(std::size_t first, std::size_t last, int axis, Cut& best) {
        const std::vector<uint>& order = orders_[axis];
        const std::size_t count = last - first, blocks_here = blocks_of(count);
        right_area_.resize(blocks_here);
        ItemBox box;
        for (std::size_t i = count; i-- > block_size;) {
            box.add(items_[order[first + i]].box);
            if (i % block_size == 0) right_area_[i / block_size] = box.area();
        }
        const ItemBox after_first_block = box;
        box = {};
        for (std::size_t i = 0; i < block_size * (blocks_here - 1); ++i) {
            box.add(items_[order[first + i]].box);
            const std::size_t left = (i + 1) / block_size;
            if ((i + 1) % block_size == 0)
                best.improve({box.area() * double(left) + right_area_[left] * double(blocks_here - left), axis, i + 1});
        }
        box.add(after_first_block);
        return box;
    }

    std::size_t add_leaf(std::span<Item> items) {
        Branch& branch = branches.emplace_back();
        for (const Item& item : items) branch.box.add(item.box);
        branch.block = write_block(items);
        return branches.size() - 1;
    }

    uint write_block(std::span<Item> items) {
        std::ranges::sort(items, {}, &Item::triangle);
        kernels::TriangleBlock& block = blocks.emplace_back();
        for (std::size_t lane = 0; lane < block_size; ++lane)
            write_lane(block, lane, *plan_, lane < items.size() ? items[lane].triangle : NONE);
        return static_cast<uint>(blocks.size() - 1);
    }

    const TreePlan* plan_ = nullptr;
    std::span<Item> items_;
    std::array<std::vector<uint>, 3> orders_; ///< of the items, along each axis
    std::vector<Key> keys_;                   ///< of the axis that is sorted
    std::vector<char> is_left_;               ///< by item
    std::vector<uint> rest_;
    std::vector<Item> leaf_;
    std::vector<double> right_area_;
};

class Builder {
public:
    Builder(TriangleTree& tree, const TreePlan& plan, Executor& executor)
        : tree_(tree), plan_(plan), executor_(executor) {}

    // False when the tree came out too deep.
    bool build(std::vector<Item>& items) {
        split(items);
        for (const bool four_levels : {plan_.balanced, true}) {
            weigh(four_levels);
            tree_.nodes.clear();
            if (!collapse(0, 0, 1)) continue;
            tree_.nodes.shrink_to_fit();
            return true;
        }
        return false;
    }

private:
    struct Part {
        std::size_t branch = 0;          ///< its root
        std::size_t first = 0, last = 0; ///< items
        ItemBox box;                     ///< of a large one
    };

    // Large parts are split first; then each part grows its own subtree.
    void split(std::vector<Item>& items) {
        const std::size_t sweep_at_most = plan_.balanced ? block_size : 1 << 14;
        branches_.emplace_back();
        const auto items_of = [&](const Part& p) { return std::span(items).subspan(p.first, p.last - p.first); };
        auto parts = divide(
            executor_, Part{0, 0, items.size(), {}}, [&](const Part& p) { return p.last - p.first > sweep_at_most; },
            [&](Part& p) {
                const std::size_t middle = p.first + split_longest(items_of(p), p.box);
                return std::array{Part{0, p.first, middle, {}}, Part{0, middle, p.last, {}}};
            },
            [&](const Part& p, std::array<Part, 2>& halves) {
                halves[0].branch = branches_.size();
                halves[1].branch = branches_.size() + 1;
                branches_[p.branch].box = p.box;
                branches_[p.branch].left = halves[0].branch;
                branches_[p.branch].right = halves[1].branch;
                branches_.resize(branches_.size() + 2);
            });
        std::ranges::sort(parts, {}, &Part::first);
        std::vector<Subtree> subtrees(parts.size());
        for_each_part(executor_, parts, [&](const Part& p) {
            subtrees[static_cast<std::size_t>(&p - parts.data())].build(plan_, items_of(p));
        });
        items = {};
        std::size_t blocks = 0, branches = branches_.size();
        for (const Subtree& subtree : subtrees) {
            blocks += subtree.blocks.size();
            branches += subtree.branches.size();
        }
        tree_.triangle_blocks.reserve(blocks);
        branches_.reserve(branches);
        for (std::size_t i = 0; i < parts.size(); ++i) graft(std::exchange(subtrees[i], {}), parts[i].branch);
    }

    // The subtree's root takes the place of a branch; the others are appended.
    void graft(const Subtree& subtree, std::size_t at) {
        const std::size_t shift = branches_.size() - 1;
        const auto first_block = static_cast<uint>(tree_.triangle_blocks.size());
        for (std::size_t i = 0; i < subtree.branches.size(); ++i) {
            Branch branch = subtree.branches[i];
            if (branch.left == 0) {
                branch.block += first_block;
            } else {
                branch.left += shift;
                branch.right += shift;
            }
            if (i == 0)
                branches_[at] = branch;
            else
                branches_.push_back(branch);
        }
        tree_.triangle_blocks.insert(tree_.triangle_blocks.end(), subtree.blocks.begin(), subtree.blocks.end());
    }

    // Chooses the binary branches that become wide nodes so that the sum of their areas, the expected number of nodes
    // that a ray visits, is least. From the leaves up, it finds the cheapest way to cover each branch with up to 1, 2,
    // ... leaves and nodes (after Pinter 2010). Opening the largest branches first would leave most nodes above the
    // leaves nearly empty. four_levels: always four levels of branches, to bound the depth.
    void weigh(bool four_levels) {
        ways_.assign(branches_.size(), {});
        for (std::size_t id = branches_.size(); id-- > 0;) { // children come after their parents
            const Branch& b = branches_[id];
            if (b.left == 0) continue; // a leaf is tested however it is reached
            const Ways &left = ways_[b.left], &right = ways_[b.right];
            Ways& ways = ways_[id];
            for (uint most = 1; most < NODE_LANES; ++most) {
                ways[most] = {infinite, (most + 1) / 2};
                for (uint k = 0; k < most && !four_levels; ++k) {
                    const float cost = left[k].cost + right[most - 1 - k].cost;
                    if (cost < ways[most].cost) ways[most] = {cost, k + 1};
                }
            }
            ways[0] = {static_cast<float>(b.box.area()) + ways[NODE_LANES - 1].cost, 0};
            for (std::size_t most = 1; most + 1 < NODE_LANES && !four_levels; ++most)
                if (ways[0].cost <= ways[most].cost) ways[most] = ways[0];
        }
    }

    // Finds up to `most` children of a wide node that cover a branch.
    void cover(std::size_t branch, std::size_t most, std::vector<std::size_t>& children) const {
        const Branch& b = branches_[branch];
        const std::size_t of_left = ways_[branch][most - 1].of_left;
        if (of_left == 0) return children.push_back(branch);
        cover(b.left, of_left, children);
        cover(b.right, most - of_left, children);
    }

    bool collapse(std::size_t branch, uint parent, int level) {
        if (level > plan_.levels) return false;
        const uint id = static_cast<uint>(tree_.nodes.size());
        tree_.nodes.emplace_back();
        std::vector<std::size_t> children;
        cover(branch, NODE_LANES, children);
        kernels::Node node{};
        node.parent = parent;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            const bool empty = lane >= children.size();
            write_box(node, lane, empty ? nullptr : &branches_[children[lane]].box, plan_.grow);
            node.child[lane] = NONE;
            if (empty) continue;
            const Branch& b = branches_[children[lane]];
            if (b.left == 0) {
                node.child[lane] = LEAF | b.block;
            } else {
                node.child[lane] = static_cast<uint>(tree_.nodes.size());
                if (!collapse(children[lane], id, level + 1)) return false;
            }
        }
        tree_.nodes[id] = node;
        return true;
    }

    TriangleTree& tree_;
    const TreePlan& plan_;
    Executor& executor_;
    std::vector<Branch> branches_;
    std::vector<Ways> ways_; ///< by branch
};

} // namespace

bool build_tree(TriangleTree& tree, const TreePlan& plan, Executor& executor) {
    std::vector<Item> items;
    items.reserve(plan.chosen.size());
    for (const std::uint32_t i : plan.chosen) {
        Item item{box_of_triangle(plan, i), {}, i};
        for (int axis = 0; axis < 3; ++axis) item.centre[axis] = item.box.low[axis] + item.box.high[axis];
        items.push_back(item);
    }
    tree.triangle_blocks.clear();
    return Builder(tree, plan, executor).build(items);
}

} // namespace raycontact
