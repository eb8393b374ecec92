// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/vector.h>

#include <array>
#include <span>

namespace raycontact {

/// Rigid placement of a body: x_world = rotation * x_body + translation. Right-handed, metres.
struct Pose {
    std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1}; ///< row-major, orthonormal, determinant +1
    Vec3 translation{};                                        ///< of the body origin, world frame, metres
    friend bool operator==(const Pose&, const Pose&) = default;
};

/// From a row-major 4x4 matrix. Throws InputError when an entry is not finite, the last row is not 0 0 0 1 or the
/// matrix is not rigid to 1e-4 (sheared, scaled or mirrored). Within that, the nearest rotation is taken (polar
/// decomposition), so the rest of the library may rely on rotation^T being its inverse.
RAYCONTACT_API Pose pose_from_matrix(std::span<const double, 16> row_major);

/// The rigid pose nearest to one that is not: its rotation drifted, as a product of many float matrices does, or is
/// scaled or sheared. Body to world; the rotation is that of the polar decomposition, the translation (metres) stays.
/// The rest, rotation^T * given.rotation, is dropped: a symmetric stretch in the body frame, the identity where the
/// pose was rigid. A body that shall be stretched needs a mesh that is. Throws InputError when an entry is not finite,
/// and when the rotation is mirrored or flat (determinant at most 1e-9 of its largest entry's cube).
RAYCONTACT_API Pose nearest_rigid_pose(const Pose& pose);

/// From a translation and a unit quaternion (w, x, y, z); it is normalised. Throws InputError when it is zero, when its
/// squared length is beyond double (of lengths from 1e-150 to 1e150 it is not), and when a number is not finite.
RAYCONTACT_API Pose pose_from_quaternion(const Vec3& translation, double w, double x, double y, double z);

/// Throws InputError naming `who` unless every entry is finite and the rotation is orthonormal to 1e-4, unmirrored.
RAYCONTACT_API void check_pose(const Pose& pose, const char* who);

/// The point in the world frame, double precision.
RAYCONTACT_API Vec3 transform_point(const Pose& pose, const Vec3& body_point);

/// The pose of `inner` seen from the frame of `outer`: inverse(outer) * inner, formed in double precision.
RAYCONTACT_API Pose relative_pose(const Pose& outer, const Pose& inner);

} // namespace raycontact
