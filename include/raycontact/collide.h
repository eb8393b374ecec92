// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>
#include <raycontact/pose.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace raycontact {

struct CollideOptions {
    Direction direction = Direction::reprojected;
    Features features = Features::edges;
    std::uint32_t threads = 1; ///< 0: one per core
};

/// The contacts of two meshes, once, without a scene: those that a Scene with the two bodies would find, sorted alike.
/// `a` is body 0 and `b` body 1; normals point from a to b. It copies the arrays of both shapes: to ask about the same
/// shapes in many poses, keep a Scene. Safe to call from several threads. Throws InputError for a pose that is not
/// finite and rigid.
std::vector<Contact> collide(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                             const CollideOptions& options = {});

/// Whether two meshes share a point: their surfaces meet (touching counts), or one lies inside the other, if that is
/// closed and wound alike everywhere. Exact for the vertices of `a` rounded to double in the frame of `b`: no tolerance
/// decides. Ends at the first triangles that meet; copies nothing. Safe to call from several threads. Throws InputError
/// as collide().
bool intersects(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

/// A point that both share, world frame, metres, to rounding: where two triangles meet, or a vertex of the one inside
/// the other. Nothing if intersects() is false.
std::optional<Vec3> common_point(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

/// Whether a point lies in a mesh that is closed and wound alike everywhere, or on its surface; false for others.
/// Decided by exact predicates. Body frame, metres. Safe to call from several threads.
bool contains(const Shape& shape, const Vec3& point);

} // namespace raycontact
