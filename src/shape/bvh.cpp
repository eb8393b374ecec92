// SPDX-License-Identifier: Apache-2.0
#include "shape/bvh.h"

#include "mesh/vector.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace raycontact {

namespace {

using kernels::uint;
constexpr std::size_t block_size = TRIANGLE_LANES;

struct Box {
    std::array<float, 3> low{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(),
                             std::numeric_limits<float>::max()};
    std::array<float, 3> high{std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest(),
                              std::numeric_limits<float>::lowest()};

    void add(const Box& other) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], other.low[i]);
            high[i] = std::max(high[i], other.high[i]);
        }
    }
    double area() const {
        const double x = double(high[0]) - double(low[0]), y = double(high[1]) - double(low[1]),
                     z = double(high[2]) - double(low[2]);
        return x < 0 ? 0 : x * y + y * z + z * x;
    }
};

struct Item {
    Box box;
    std::array<float, 3> centre; // doubled: only its order matters
    uint triangle;
};

// How a branch is covered at the least cost: by itself, or so many for its left part and the rest for its right.
struct Way {
    float cost = 0;
    int of_left = 0;
};

struct Branch {
    Box box;
    int left = -1, right = -1;
    uint block = 0; // of a leaf
};

class Builder {
public:
    Builder(ShapeData& shape, double grow, bool balanced) : shape_(shape), grow_(grow), balanced_(balanced) {}

    // False when the tree came out too deep for the traversal's trail.
    bool build(std::vector<Item> items) {
        items_ = std::move(items);
        const int root = split(0, items_.size());
        if (!balanced_) {
            weigh();
            if (collapse(root, 0, 1)) return true;
            ways_ = {};
            shape_.nodes.clear();
        }
        return collapse(root, 0, 1);
    }

private:
    int split(std::size_t begin, std::size_t end) {
        const int id = static_cast<int>(branches_.size());
        branches_.emplace_back();
        Box box;
        for (std::size_t i = begin; i < end; ++i) box.add(items_[i].box);
        branches_[id].box = box;
        if (end - begin <= block_size) {
            branches_[id].block = write_block(begin, end);
            return id;
        }
        const std::size_t middle = begin + partition(std::span(items_).subspan(begin, end - begin));
        const int left = split(begin, middle);
        const int right = split(middle, end);
        branches_[id].left = left;
        branches_[id].right = right;
        return id;
    }

    static auto order(int axis) {
        return [axis](const Item& a, const Item& b) {
            return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.triangle < b.triangle;
        };
    }

    // Sorts the items so that the first n, a multiple of a block, make the left child; returns n.
    std::size_t partition(std::span<Item> items) {
        constexpr std::size_t sweep_at_most = 1 << 14;
        const std::size_t blocks = (items.size() + block_size - 1) / block_size;
        int best_axis = 0;
        std::size_t best_left = block_size * (blocks / 2);
        if (balanced_ || items.size() > sweep_at_most) {
            // The longest axis in the middle: good enough where a sweep would cost too much.
            Box centres;
            for (const Item& item : items) centres.add({item.centre, item.centre});
            for (int axis = 1; axis < 3; ++axis)
                if (centres.high[axis] - centres.low[axis] > centres.high[best_axis] - centres.low[best_axis])
                    best_axis = axis;
        } else {
            double best_cost = std::numeric_limits<double>::infinity();
            for (int axis = 0; axis < 3; ++axis) {
                std::sort(items.begin(), items.end(), order(axis));
                sweep(items, axis, best_cost, best_axis, best_left);
            }
        }
        std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(best_left), items.end(),
                         order(best_axis));
        return best_left;
    }

    void sweep(std::span<const Item> items, int axis, double& best_cost, int& best_axis, std::size_t& best_left) {
        const std::size_t blocks = (items.size() + block_size - 1) / block_size;
        right_area_.assign(blocks + 1, 0);
        Box box;
        for (std::size_t i = items.size(); i-- > block_size;) {
            box.add(items[i].box);
            if (i % block_size == 0) right_area_[i / block_size] = box.area();
        }
        box = {};
        for (std::size_t i = 0; i + 1 < items.size(); ++i) {
            box.add(items[i].box);
            if ((i + 1) % block_size != 0) continue;
            const std::size_t left = (i + 1) / block_size;
            const double cost = box.area() * double(left) + right_area_[left] * double(blocks - left);
            if (cost < best_cost) {
                best_cost = cost;
                best_axis = axis;
                best_left = i + 1;
            }
        }
    }

    uint write_block(std::size_t begin, std::size_t end) {
        std::sort(items_.begin() + static_cast<std::ptrdiff_t>(begin),
                  items_.begin() + static_cast<std::ptrdiff_t>(end),
                  [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
        kernels::TriangleBlock block;
        for (std::size_t lane = 0; lane < block_size; ++lane) {
            const bool empty = begin + lane >= end;
            block.triangle[lane] = empty ? NONE : items_[begin + lane].triangle;
            block.cap[lane] = 0;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                constexpr float nan = std::numeric_limits<float>::quiet_NaN();
                Point3f p{nan, nan, nan};
                if (!empty) p = shape_.points[shape_.mesh.triangles[items_[begin + lane].triangle][corner]];
                block.corner[3 * corner + 0][lane] = p.x;
                block.corner[3 * corner + 1][lane] = p.y;
                block.corner[3 * corner + 2][lane] = p.z;
            }
        }
        shape_.triangle_blocks.push_back(block);
        return static_cast<uint>(shape_.triangle_blocks.size() - 1);
    }

    // Which binary branches become wide nodes, so that the sum of their areas, the nodes that a ray is expected to
    // visit, is least: of each branch, the cheapest way to cover it with up to so many leaves and nodes, from below
    // (after Pinter 2010). The largest branches opened first would leave most nodes above the leaves nearly empty.
    void weigh() {
        ways_.resize(branches_.size());
        for (std::size_t id = branches_.size(); id-- > 0;) { // children come after their parents
            const Branch& b = branches_[id];
            std::array<Way, NODE_LANES>& ways = ways_[id];
            if (b.left < 0) continue; // a leaf is tested however it is reached
            const auto &left = ways_[b.left], &right = ways_[b.right];
            for (std::size_t most = 1; most < NODE_LANES; ++most) {
                ways[most].cost = std::numeric_limits<float>::infinity();
                for (std::size_t k = 0; k < most; ++k) {
                    const float cost = left[k].cost + right[most - 1 - k].cost;
                    if (cost < ways[most].cost) ways[most] = {cost, static_cast<int>(k) + 1};
                }
            }
            ways[0] = {static_cast<float>(b.box.area()) + ways[NODE_LANES - 1].cost, 0};
            for (std::size_t most = 1; most + 1 < NODE_LANES; ++most)
                if (ways[0].cost <= ways[most].cost) ways[most] = ways[0];
        }
    }

    // What covers a branch with up to `most` children of a wide node.
    void cover(int branch, std::size_t most, std::vector<int>& children) const {
        const int of_left = ways_[branch][most - 1].of_left;
        if (of_left == 0) return children.push_back(branch);
        cover(branches_[branch].left, static_cast<std::size_t>(of_left), children);
        cover(branches_[branch].right, most - static_cast<std::size_t>(of_left), children);
    }

    std::vector<int> children_of(int branch) const {
        if (ways_.empty()) return four_levels(branch);
        std::vector<int> children;
        cover(branch, NODE_LANES, children);
        return children;
    }

    // To bound the depth.
    std::vector<int> four_levels(int branch) const {
        std::vector<int> children{branch};
        while (children.size() < NODE_LANES) {
            // Breadth first: the children go to the end of the queue.
            const auto next =
                std::find_if(children.begin(), children.end(), [&](int child) { return branches_[child].left >= 0; });
            if (next == children.end()) break;
            const Branch& b = branches_[*next];
            children.erase(next);
            children.push_back(b.left);
            children.push_back(b.right);
        }
        return children;
    }

    bool collapse(int branch, uint parent, int level) {
        if (level > NODE_LEVELS) return false;
        const uint id = static_cast<uint>(shape_.nodes.size());
        shape_.nodes.emplace_back();
        const std::vector<int> children = children_of(branch);
        kernels::Node node{};
        node.parent = parent;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            const bool empty = lane >= children.size();
            for (int axis = 0; axis < 3; ++axis) {
                // Empty lanes are inverted so far that no ray enters before it leaves.
                constexpr float huge = 1e30f;
                node.bounds[axis][lane] = empty ? huge : down(branches_[children[lane]].box.low[axis]);
                node.bounds[3 + axis][lane] = empty ? -huge : up(branches_[children[lane]].box.high[axis]);
            }
            node.child[lane] = NONE;
            if (empty) continue;
            const Branch& b = branches_[children[lane]];
            if (b.left < 0) {
                node.child[lane] = LEAF | b.block;
            } else {
                node.child[lane] = static_cast<uint>(shape_.nodes.size());
                if (!collapse(children[lane], id, level + 1)) return false;
            }
        }
        shape_.nodes[id] = node;
        return true;
    }

    float down(float x) const { return std::nextafter(static_cast<float>(double(x) - grow_), -1e38f); }
    float up(float x) const { return std::nextafter(static_cast<float>(double(x) + grow_), 1e38f); }

    ShapeData& shape_;
    double grow_;
    bool balanced_;
    std::vector<Item> items_;
    std::vector<Branch> branches_;
    std::vector<std::array<Way, NODE_LANES>> ways_; ///< by branch, with up to 1, 2, ... of them
    std::vector<double> right_area_;
};

} // namespace

void build_bvh(ShapeData& shape, std::span<const Vec3> face_normals, double grow) {
    std::vector<Item> items;
    items.reserve(shape.mesh.triangles.size());
    for (uint i = 0; i < shape.mesh.triangles.size(); ++i) {
        if (face_normals[i] == Vec3{}) continue;
        Item item;
        item.triangle = i;
        for (const std::uint32_t v : shape.mesh.triangles[i]) {
            const Point3f p = shape.points[v];
            item.box.add({{p.x, p.y, p.z}, {p.x, p.y, p.z}});
        }
        for (int axis = 0; axis < 3; ++axis) item.centre[axis] = item.box.low[axis] + item.box.high[axis];
        items.push_back(item);
    }
    for (const bool balanced : {false, true}) {
        shape.triangle_blocks.clear();
        shape.nodes.clear();
        if (Builder(shape, grow, balanced).build(items)) return;
    }
    throw InputError("mesh '" + shape.mesh.name + "': more than 16 million triangles; split it into several meshes");
}

} // namespace raycontact
