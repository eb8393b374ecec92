// SPDX-License-Identifier: Apache-2.0
#include "shape/build.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

using kernels::uint;
constexpr std::size_t block_size = TRIANGLE_LANES;
constexpr float infinite = std::numeric_limits<float>::infinity();

struct Box {
    std::array<float, 3> low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};

    void add(const Box& other) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], other.low[i]);
            high[i] = std::max(high[i], other.high[i]);
        }
    }
    double area() const {
        const double x = double(high[0]) - double(low[0]), y = double(high[1]) - double(low[1]),
                     z = double(high[2]) - double(low[2]);
        return x * y + y * z + z * x;
    }
};

struct Item {
    Box box;
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
    std::size_t of_left = 0;
};

struct Branch {
    Box box;
    std::size_t left = 0, right = 0;    // 0: a leaf
    uint block = 0;                     // of a leaf
    std::array<Way, NODE_LANES> ways{}; // with up to 1, 2, ... of them
};

class Builder {
public:
    Builder(ShapeData& shape, double grow, bool balanced) : shape_(shape), grow_(grow), balanced_(balanced) {}

    // False when the tree came out too deep for the traversal's trail.
    bool build(std::vector<Item>& items) {
        split(items);
        for (const bool four_levels : {balanced_, true}) {
            weigh(four_levels);
            shape_.nodes.clear();
            if (collapse(0, 0, 1)) return true;
        }
        return false;
    }

private:
    std::size_t split(std::span<Item> items) {
        const std::size_t id = branches_.size();
        branches_.emplace_back();
        for (const Item& item : items) branches_[id].box.add(item.box);
        if (items.size() <= block_size) {
            branches_[id].block = write_block(items);
            return id;
        }
        const std::size_t middle = partition(items);
        const std::size_t left = split(items.first(middle)), right = split(items.subspan(middle));
        branches_[id].left = left;
        branches_[id].right = right;
        return id;
    }

    // Sorts the items so that the first n, a multiple of a block, make the left child; returns n.
    std::size_t partition(std::span<Item> items) {
        constexpr std::size_t sweep_at_most = 1 << 14;
        const auto before = [](int axis) {
            return [axis](const Item& a, const Item& b) {
                return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.triangle < b.triangle;
            };
        };
        Cut best;
        for (int axis = 0; axis < 3; ++axis)
            if (balanced_ || items.size() > sweep_at_most) {
                // The longest axis, split in the middle: good enough if a sweep would cost too much.
                const auto [low, high] = std::minmax_element(items.begin(), items.end(), before(axis));
                best.improve({low->centre[axis] - high->centre[axis], axis, block_size * (blocks_of(items) / 2)});
            } else {
                std::sort(items.begin(), items.end(), before(axis));
                sweep(items, axis, best);
            }
        std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(best.left), items.end(),
                         before(best.axis));
        return best.left;
    }

    static std::size_t blocks_of(std::span<const Item> items) { return (items.size() + block_size - 1) / block_size; }

    void sweep(std::span<const Item> items, int axis, Cut& best) {
        const std::size_t blocks = blocks_of(items);
        right_area_.resize(blocks);
        Box box;
        for (std::size_t i = items.size(); i-- > block_size;) {
            box.add(items[i].box);
            if (i % block_size == 0) right_area_[i / block_size] = box.area();
        }
        box = {};
        for (std::size_t i = 0; i < block_size * (blocks - 1); ++i) {
            box.add(items[i].box);
            const std::size_t left = (i + 1) / block_size;
            if ((i + 1) % block_size == 0)
                best.improve({box.area() * double(left) + right_area_[left] * double(blocks - left), axis, i + 1});
        }
    }

    uint write_block(std::span<Item> items) {
        std::ranges::sort(items, {}, &Item::triangle);
        const auto id = static_cast<uint>(shape_.triangle_blocks.size());
        kernels::TriangleBlock& block = shape_.triangle_blocks.emplace_back();
        for (std::size_t lane = 0; lane < block_size; ++lane) {
            const bool empty = lane >= items.size();
            block.triangle[lane] = empty ? NONE : items[lane].triangle;
            block.cap[lane] = 0;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                constexpr float nan = std::numeric_limits<float>::quiet_NaN();
                const Point3f p =
                    empty ? Point3f{nan, nan, nan} : shape_.points[shape_.mesh.triangles[items[lane].triangle][corner]];
                block.corner[3 * corner + 0][lane] = p.x;
                block.corner[3 * corner + 1][lane] = p.y;
                block.corner[3 * corner + 2][lane] = p.z;
            }
            if (!empty) shape_.faces[items[lane].triangle].triangle_lane = static_cast<uint>(block_size * id + lane);
        }
        return id;
    }

    // Chooses the binary branches that become wide nodes so that the sum of their areas, the expected number of nodes
    // that a ray visits, is least. From the leaves up, it finds the cheapest way to cover each branch with up to 1, 2,
    // ... leaves and nodes (after Pinter 2010). Opening the largest branches first would leave most nodes above the
    // leaves nearly empty. four_levels: always four levels of branches, to bound the depth.
    void weigh(bool four_levels) {
        for (std::size_t id = branches_.size(); id-- > 0;) { // children come after their parents
            Branch& b = branches_[id];
            if (b.left == 0) continue; // a leaf is tested however it is reached
            const auto &left = branches_[b.left].ways, &right = branches_[b.right].ways;
            for (std::size_t most = 1; most < NODE_LANES; ++most) {
                b.ways[most] = {infinite, (most + 1) / 2};
                for (std::size_t k = 0; k < most && !four_levels; ++k) {
                    const float cost = left[k].cost + right[most - 1 - k].cost;
                    if (cost < b.ways[most].cost) b.ways[most] = {cost, k + 1};
                }
            }
            b.ways[0] = {static_cast<float>(b.box.area()) + b.ways[NODE_LANES - 1].cost, 0};
            for (std::size_t most = 1; most + 1 < NODE_LANES && !four_levels; ++most)
                if (b.ways[0].cost <= b.ways[most].cost) b.ways[most] = b.ways[0];
        }
    }

    // Finds up to `most` children of a wide node that cover a branch.
    void cover(std::size_t branch, std::size_t most, std::vector<std::size_t>& children) const {
        const Branch& b = branches_[branch];
        const std::size_t of_left = b.ways[most - 1].of_left;
        if (of_left == 0) return children.push_back(branch);
        cover(b.left, of_left, children);
        cover(b.right, most - of_left, children);
    }

    bool collapse(std::size_t branch, uint parent, int level) {
        if (level > NODE_LEVELS) return false;
        const uint id = static_cast<uint>(shape_.nodes.size());
        shape_.nodes.emplace_back();
        std::vector<std::size_t> children;
        cover(branch, NODE_LANES, children);
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
            if (b.left == 0) {
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
    std::vector<Branch> branches_;
    std::vector<double> right_area_;
};

} // namespace

void build_bvh(ShapeData& shape, std::span<const Vec3> normals, double grow) {
    std::vector<Item> items;
    for (uint i = 0; i < shape.mesh.triangles.size(); ++i) {
        if (normals[i] == Vec3{}) continue;
        Item item{{}, {}, i};
        for (const std::uint32_t v : shape.mesh.triangles[i]) {
            const Point3f p = shape.points[v];
            item.box.add({{p.x, p.y, p.z}, {p.x, p.y, p.z}});
        }
        for (int axis = 0; axis < 3; ++axis) item.centre[axis] = item.box.low[axis] + item.box.high[axis];
        items.push_back(item);
    }
    for (const bool balanced : {false, true}) {
        shape.triangle_blocks.clear();
        if (Builder(shape, grow, balanced).build(items)) return;
    }
    throw InputError("mesh '" + shape.mesh.name + "': more than 16 million triangles; split it into several meshes");
}

} // namespace raycontact
