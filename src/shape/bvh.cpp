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

    // Up to sixteen descendants become the children of one wide node: the largest is opened first, or, to bound the
    // depth, four levels at once.
    std::vector<int> children_of(int branch) const {
        std::vector<int> children{branch};
        for (int opened = 0; children.size() < NODE_LANES && opened < NODE_LANES - 1; ++opened) {
            int largest = -1;
            double area = -1;
            for (std::size_t i = 0; i < children.size(); ++i) {
                const Branch& b = branches_[children[i]];
                // Balanced: always the first unopened of the shallowest level, that is, breadth first.
                if (b.left >= 0 && (balanced_ ? largest < 0 : b.box.area() > area)) {
                    largest = static_cast<int>(i);
                    area = b.box.area();
                }
            }
            if (largest < 0) break;
            const Branch& b = branches_[children[largest]];
            if (balanced_) { // breadth first: the children go to the end of the queue
                children.erase(children.begin() + largest);
                children.push_back(b.left);
                children.push_back(b.right);
            } else {
                children[largest] = b.left;
                children.insert(children.begin() + largest + 1, b.right);
            }
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
