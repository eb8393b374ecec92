// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <extent.h>
#include <raycontact/shape.h>

#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

namespace raycontact::bullet {

/// A shape in Bullet's numbers: the vertices that Bullet's own algorithms see, and its box in the world. Body frame,
/// metres.
class BulletMesh {
public:
    explicit BulletMesh(std::shared_ptr<const Shape> shape);

    /// k: any; they go round.
    const btVector3& corner(std::uint32_t t, int k) const {
        return vertices_[triangles_[t][static_cast<std::size_t>(k % 3)]];
    }
    /// Triangles whose own boxes overlap [low, high], ascending.
    std::vector<std::uint32_t> overlapping(const btVector3& low, const btVector3& high) const;
    /// Where the surface ends: an edge of one triangle, beyond which no other goes on, as beyond a T-junction.
    struct FreeBorder {
        std::vector<bool> edges;    ///< 3 t + k
        std::vector<bool> vertices; ///< of these
    };
    /// Made when it is first asked for. On any thread.
    const FreeBorder& free_border() const;

    /// Box of the mesh in a frame with these axes and origin (rows of a rotation, a translation): exact for up to 1024
    /// vertices, beyond that of the rotated boxes of at most 1024 groups of triangles. Bullet asks for the box of every
    /// body in every step, asleep or not, each time by the body's own transform: its address says which box may do, its
    /// value whether it does. On any thread.
    void bounds(const btTransform& transform, btVector3& low, btVector3& high) const;
    /// How many boxes bounds() has made, and how many vertices or groups each looked at.
    std::uint64_t bounds_made() const { return bounds_made_; }
    std::size_t bounds_size() const { return extent().size(); }

private:
    struct Box {
        btTransform transform;
        btVector3 low, high;
    };
    const Extent& extent() const;
    bool goes_on(std::uint32_t t, int k) const;
    bool lies_on(std::uint32_t t, int k, std::uint32_t other) const;

    std::shared_ptr<const Shape> shape_; ///< has the triangles
    std::vector<btVector3> vertices_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
    mutable std::once_flag made_, border_made_;
    mutable FreeBorder border_; ///< after border_made_
    mutable Extent extent_;     ///< after made_: of all vertices, where there are few, or of boxes of the shape's tree
    mutable std::mutex boxes_in_use_;
    mutable std::unordered_map<const btTransform*, Box> boxes_; ///< by addresses that may be gone
    mutable std::atomic<std::uint64_t> bounds_made_ = 0;
};

} // namespace raycontact::bullet
