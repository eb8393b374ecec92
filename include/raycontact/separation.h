// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>
#include <raycontact/export.h>
#include <raycontact/pose.h>
#include <raycontact/shape.h>

namespace raycontact {

/// How far two meshes are apart, or how far the second has to go so that they are.
struct Separation {
    /// Metres. Of meshes that share no point their distance; else below 0: minus the length of a translation that parts
    /// them.
    double distance = 0;
    Vec3 normal;  ///< from a to b, unit, world frame: b moved by -distance along it is parted from a; the gradient
    Vec3 point_a; ///< on the surface of a, world frame: of the closest points; of meshes that are parted, once they are
    Vec3 point_b; ///< likewise on that of b, which is where it is given
};

/// The signed distance of two meshes: outside as distance() has it, inside by a translation. Once b has moved by that,
/// they share no point, as intersects() has it, and are some 1e-6 of the smaller mesh's diagonal apart. Two convex
/// meshes cannot be parted by one that is shorter by 1 %, but for that gap. Of others it is the best that was found
/// from stated starts: the way out of their hulls, pushes by their deepest contacts, the normals of these, and 26
/// directions of a's frame; each is gone back until something is in the way, and turned by the normals of what is met
/// there (docs/queries.md). Throws InputError for poses as intersects().
RAYCONTACT_API Separation separation(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

} // namespace raycontact
