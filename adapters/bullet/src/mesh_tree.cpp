// SPDX-License-Identifier: Apache-2.0
#include <mesh_tree.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace raycontact::bullet {

namespace {
constexpr std::uint32_t leaf_triangles = 8;
constexpr std::size_t exact_bounds = 1024;
} // namespace

MeshTree::MeshTree(const Shape& shape) : triangles_(shape.triangles().begin(), shape.triangles().end()) {
    vertices_.reserve(shape.vertices().size());
    for (const Vec3& v : shape.vertices()) vertices_.emplace_back(btScalar(v.x), btScalar(v.y), btScalar(v.z));
    order_.resize(triangles_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    build();

    if (vertices_.size() <= exact_bounds) {
        for (const btVector3& v : vertices_) cover_.push_back({v, btVector3(0, 0, 0)});
    } else {
        for (const Node& node : nodes_) {
            if (node.begin != node.end)
                cover_.push_back({(node.low + node.high) * btScalar(0.5), (node.high - node.low) * btScalar(0.5)});
        }
    }
}

/// What triangles are sorted by: read in their order, it is a third of the time of looking at their vertices.
struct MeshTree::Sorting {
    struct Item {
        btVector3 low, high;
        btVector3 centroid3; ///< three times the centroid orders the same
    };
    std::vector<Item> items; ///< by triangle
    std::vector<std::pair<btScalar, std::uint32_t>> keys;
};

void MeshTree::build() {
    Sorting sorting;
    sorting.items.reserve(triangles_.size());
    for (const auto& t : triangles_) {
        btVector3 low = vertices_[t[0]], high = low;
        for (int k = 1; k < 3; ++k) {
            low.setMin(vertices_[t[k]]);
            high.setMax(vertices_[t[k]]);
        }
        sorting.items.push_back({low, high, vertices_[t[0]] + vertices_[t[1]] + vertices_[t[2]]});
    }
    sorting.keys.resize(triangles_.size());
    nodes_.reserve(triangles_.size() / (leaf_triangles / 4) + 1);
    build(0, static_cast<std::uint32_t>(order_.size()), sorting);
    nodes_.shrink_to_fit();
}

void MeshTree::build(std::uint32_t begin, std::uint32_t end, Sorting& sorting) {
    const std::size_t index = nodes_.size();
    Node& node = nodes_.emplace_back();
    const Sorting::Item& any = sorting.items[order_[begin]];
    btVector3 low = any.low, high = any.high, first = any.centroid3, last = first;
    for (std::uint32_t k = begin + 1; k < end; ++k) {
        const Sorting::Item& item = sorting.items[order_[k]];
        low.setMin(item.low);
        high.setMax(item.high);
        first.setMin(item.centroid3);
        last.setMax(item.centroid3);
    }
    node.low = low;
    node.high = high;
    if (end - begin <= leaf_triangles) {
        node.begin = begin;
        node.end = end;
    } else {
        const int axis = (last - first).maxAxis();
        const std::uint32_t middle = begin + (end - begin) / 2;
        const auto keys = sorting.keys.begin();
        for (std::uint32_t k = begin; k < end; ++k) keys[k] = {sorting.items[order_[k]].centroid3[axis], order_[k]};
        std::nth_element(keys + begin, keys + middle, keys + end);
        for (std::uint32_t k = begin; k < end; ++k) order_[k] = keys[k].second;
        build(begin, middle, sorting);
        build(middle, end, sorting);
    }
    nodes_[index].skip = static_cast<std::uint32_t>(nodes_.size());
}

bool MeshTree::triangle_overlaps(std::uint32_t index, const btVector3& low, const btVector3& high) const {
    const auto& t = triangles_[index];
    btVector3 a = vertices_[t[0]], b = a;
    for (int k = 1; k < 3; ++k) {
        a.setMin(vertices_[t[k]]);
        b.setMax(vertices_[t[k]]);
    }
    return overlap(a, b, low, high);
}

void MeshTree::vertices_below(const btVector3& normal, btScalar offset, std::vector<std::uint32_t>& out) const {
    out.clear();
    const btVector3 size = normal.absolute();
    for (std::uint32_t i = 0; i < nodes_.size();) {
        const Node& node = nodes_[i];
        const btVector3 centre = (node.low + node.high) * btScalar(0.5), half = (node.high - node.low) * btScalar(0.5);
        // A little slack: a box is only pruned; the vertices themselves decide.
        const btScalar slack = btScalar(1e-5) * (size.dot(centre.absolute() + half) + btFabs(offset));
        if (normal.dot(centre) - size.dot(half) > offset + slack) {
            i = node.skip;
            continue;
        }
        for (std::uint32_t k = node.begin; k < node.end; ++k) {
            for (const std::uint32_t v : triangles_[order_[k]]) {
                if (normal.dot(vertices_[v]) < offset) out.push_back(v);
            }
        }
        ++i;
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
}

void MeshTree::bounds(const btTransform& transform, btVector3& low, btVector3& high) const {
    const btMatrix3x3& basis = transform.getBasis();
    for (int axis = 0; axis < 3; ++axis) {
        const btScalar x = basis[axis].x(), y = basis[axis].y(), z = basis[axis].z();
        btScalar least = BT_LARGE_FLOAT, most = -BT_LARGE_FLOAT;
        for (const Cover& c : cover_) {
            const btScalar p = x * c.centre.x() + y * c.centre.y() + z * c.centre.z();
            const btScalar r = btFabs(x) * c.half.x() + btFabs(y) * c.half.y() + btFabs(z) * c.half.z();
            least = p - r < least ? p - r : least;
            most = p + r > most ? p + r : most;
        }
        low[axis] = least + transform.getOrigin()[axis];
        high[axis] = most + transform.getOrigin()[axis];
    }
    low.setW(0);
    high.setW(0);
}

} // namespace raycontact::bullet
