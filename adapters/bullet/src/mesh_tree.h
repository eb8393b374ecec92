// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <box_cache.h>
#include <extent.h>
#include <raycontact/shape.h>

#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace raycontact::bullet {

/// Boxes over a shape's triangles in preorder, for Bullet's own algorithms, planes and bounds. Body frame, metres. They
/// are made when they are first asked for, on any thread: a mesh of Bullet's that meets only meshes never needs them.
class MeshTree {
public:
    explicit MeshTree(std::shared_ptr<const Shape> shape);

    const btVector3& vertex(std::uint32_t index) const { return vertices_[index]; }
    const std::array<std::uint32_t, 3>& triangle(std::uint32_t index) const { return triangles_[index]; }

    /// Calls visit(triangle) for each triangle whose own box overlaps [low, high].
    template <class Visit>
    void overlapping(const btVector3& low, const btVector3& high, Visit&& visit) const {
        const Boxes& boxes = this->boxes();
        for (std::uint32_t i = 0; i < boxes.nodes.size();) {
            const Node& node = boxes.nodes[i];
            if (!overlap(node.low, node.high, low, high)) {
                i = node.skip;
                continue;
            }
            for (std::uint32_t k = node.begin; k < node.end; ++k) {
                if (triangle_overlaps(boxes.order[k], low, high)) visit(boxes.order[k]);
            }
            ++i;
        }
    }

    /// Vertices with normal . v < offset, ascending, each once. `normal` need not be unit.
    void vertices_below(const btVector3& normal, btScalar offset, std::vector<std::uint32_t>& out) const;

    /// Box of the mesh in a frame with these axes and origin (rows of a rotation, a translation): exact for up to 1024
    /// vertices, beyond that of the rotated boxes of at most 1024 groups of triangles. Made anew only where this
    /// transform has changed since it was last asked about.
    void bounds(const btTransform& transform, btVector3& low, btVector3& high) const;
    /// The same for a transform that is gone soon, at an address of no use: its box is not kept.
    void bounds_once(const btTransform& transform, btVector3& low, btVector3& high) const;
    /// How many boxes bounds() has made, and how many vertices or groups each looked at.
    std::uint64_t bounds_made() const { return cache_.made(); }
    std::size_t bounds_size() const { return extent().size(); }

private:
    struct Node {
        btVector3 low, high;
        std::uint32_t begin = 0, end = 0; ///< triangles of a leaf, positions in the order; empty in an inner node
        std::uint32_t skip = 0;           ///< next node when this box is missed
    };
    struct Boxes {
        std::vector<std::uint32_t> order; ///< triangles, leaf by leaf
        std::vector<Node> nodes;
        Extent extent; ///< of groups of triangles
    };

    static bool overlap(const btVector3& a_low, const btVector3& a_high, const btVector3& b_low,
                        const btVector3& b_high) {
        return a_low.x() <= b_high.x() && b_low.x() <= a_high.x() && a_low.y() <= b_high.y() && b_low.y() <= a_high.y()
               && a_low.z() <= b_high.z() && b_low.z() <= a_high.z();
    }
    bool triangle_overlaps(std::uint32_t index, const btVector3& low, const btVector3& high) const;
    class Builder;
    const Boxes& boxes() const;
    const Extent& extent() const;

    std::shared_ptr<const Shape> shape_; ///< has the triangles
    std::vector<btVector3> vertices_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
    Extent points_; ///< all vertices, where there are few
    mutable BoxCache cache_;
    mutable std::once_flag made_;
    mutable Boxes boxes_; ///< after made_
};

} // namespace raycontact::bullet
