// SPDX-License-Identifier: Apache-2.0
#include <mesh_tree.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace raycontact::bullet {

namespace {
constexpr std::uint32_t leaf_triangles = 8;
constexpr std::size_t exact_bounds = 1024;
constexpr std::uint32_t most_groups = 1024; ///< of large meshes, for bounds
} // namespace

MeshTree::MeshTree(std::shared_ptr<const Shape> shape) : shape_(std::move(shape)), triangles_(shape_->triangles()) {
    vertices_.reserve(shape_->vertices().size());
    for (const Vec3& v : shape_->vertices()) vertices_.emplace_back(btScalar(v.x), btScalar(v.y), btScalar(v.z));
    if (vertices_.size() > exact_bounds) return;
    points_.reserve(vertices_.size());
    for (const btVector3& v : vertices_) points_.add(v, btVector3(0, 0, 0));
}

class MeshTree::Builder {
public:
    Builder(const MeshTree& tree, Boxes& boxes)
        : boxes_(boxes), keys_(tree.triangles_.size()),
          group_(std::max(leaf_triangles, static_cast<std::uint32_t>((keys_.size() + most_groups - 1) / most_groups))) {
        items_.reserve(tree.triangles_.size());
        for (const auto& t : tree.triangles_) {
            btVector3 low = tree.vertices_[t[0]], high = low;
            for (std::size_t k = 1; k < 3; ++k) {
                low.setMin(tree.vertices_[t[k]]);
                high.setMax(tree.vertices_[t[k]]);
            }
            items_.push_back({low, high, tree.vertices_[t[0]] + tree.vertices_[t[1]] + tree.vertices_[t[2]]});
        }
        boxes_.order.resize(items_.size());
        std::iota(boxes_.order.begin(), boxes_.order.end(), 0u);
        boxes_.nodes.reserve(items_.size() / (leaf_triangles / 4) + 1);
    }

    void build(std::uint32_t begin, std::uint32_t end, bool in_group = false) {
        const std::size_t index = boxes_.nodes.size();
        Node& node = boxes_.nodes.emplace_back();
        std::vector<std::uint32_t>& order = boxes_.order;
        const Item& any = items_[order[begin]];
        btVector3 low = any.low, high = any.high, first = any.centroid3, last = first;
        for (std::uint32_t k = begin + 1; k < end; ++k) {
            const Item& item = items_[order[k]];
            low.setMin(item.low);
            high.setMax(item.high);
            first.setMin(item.centroid3);
            last.setMax(item.centroid3);
        }
        node.low = low;
        node.high = high;
        if (!in_group && end - begin <= group_) {
            boxes_.extent.add((low + high) * btScalar(0.5), (high - low) * btScalar(0.5));
            in_group = true;
        }
        if (end - begin <= leaf_triangles) {
            node.begin = begin;
            node.end = end;
        } else {
            const int axis = (last - first).maxAxis();
            const std::uint32_t middle = begin + (end - begin) / 2;
            const auto keys = keys_.begin();
            for (std::uint32_t k = begin; k < end; ++k) keys[k] = {items_[order[k]].centroid3[axis], order[k]};
            std::nth_element(keys + begin, keys + middle, keys + end);
            for (std::uint32_t k = begin; k < end; ++k) order[k] = keys[k].second;
            build(begin, middle, in_group);
            build(middle, end, in_group);
        }
        boxes_.nodes[index].skip = static_cast<std::uint32_t>(boxes_.nodes.size());
    }

private:
    // What triangles are sorted by: read in their order, it is a third of the time of looking at their vertices.
    struct Item {
        btVector3 low, high;
        btVector3 centroid3; // three times the centroid orders the same
    };
    Boxes& boxes_;
    std::vector<Item> items_; // by triangle
    std::vector<std::pair<btScalar, std::uint32_t>> keys_;
    std::uint32_t group_; // most triangles of a group
};

const MeshTree::Boxes& MeshTree::boxes() const {
    std::call_once(made_, [this] {
        Boxes made;
        Builder(*this, made).build(0, static_cast<std::uint32_t>(triangles_.size()));
        made.nodes.shrink_to_fit();
        boxes_ = std::move(made);
    });
    return boxes_;
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
    const Boxes& boxes = this->boxes();
    for (std::uint32_t i = 0; i < boxes.nodes.size();) {
        const Node& node = boxes.nodes[i];
        const btVector3 centre = (node.low + node.high) * btScalar(0.5), half = (node.high - node.low) * btScalar(0.5);
        // A little slack: a box is only pruned; the vertices themselves decide.
        const btScalar slack = btScalar(1e-5) * (size.dot(centre.absolute() + half) + btFabs(offset));
        if (normal.dot(centre) - size.dot(half) > offset + slack) {
            i = node.skip;
            continue;
        }
        for (std::uint32_t k = node.begin; k < node.end; ++k) {
            for (const std::uint32_t v : triangles_[boxes.order[k]]) {
                if (normal.dot(vertices_[v]) < offset) out.push_back(v);
            }
        }
        ++i;
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
}

const Extent& MeshTree::extent() const {
    return vertices_.size() <= exact_bounds ? points_ : boxes().extent;
}

void MeshTree::bounds(const btTransform& transform, btVector3& low, btVector3& high) const {
    cache_.get(transform, low, high, [&](btVector3& from, btVector3& to) { extent().bounds(transform, from, to); });
}

void MeshTree::bounds_once(const btTransform& transform, btVector3& low, btVector3& high) const {
    extent().bounds(transform, low, high);
}

} // namespace raycontact::bullet
