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

/// A shape's vertices in Bullet's numbers, and what Bullet's own algorithms, planes and bounds ask of its tree. Body
/// frame, metres.
class MeshTree {
public:
    explicit MeshTree(std::shared_ptr<const Shape> shape);

    const btVector3& vertex(std::uint32_t index) const { return vertices_[index]; }
    const std::array<std::uint32_t, 3>& triangle(std::uint32_t index) const { return triangles_[index]; }

    /// Calls visit(triangle), ascending, for each triangle whose own box overlaps [low, high].
    template <class Visit>
    void overlapping(const btVector3& low, const btVector3& high, Visit&& visit) const {
        std::vector<std::uint32_t> found = overlapping(low, high);
        for (const std::uint32_t t : found) visit(t);
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
    std::vector<std::uint32_t> overlapping(const btVector3& low, const btVector3& high) const;
    const Extent& extent() const;

    std::shared_ptr<const Shape> shape_; ///< has the triangles
    std::vector<btVector3> vertices_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
    mutable BoxCache cache_;
    mutable std::once_flag made_;
    mutable Extent extent_; ///< after made_: of all vertices, where there are few, or of boxes of the shape's tree
};

} // namespace raycontact::bullet
