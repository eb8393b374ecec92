// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/pose.h>

namespace raycontact {

/// How a body moves from time 0 to time 1: one point of it moves straight, and it turns about that point, both at
/// constant rates. Straight motions, turns about any axis by any number of rounds, and screws are of this kind.
struct RigidMotion {
    Pose from;             ///< at time 0
    Vec3 velocity;         ///< of the point that moves straight, world frame, metres by unit of time
    Vec3 angular_velocity; ///< the axis, as long as the radians by unit of time, world frame; 0: the body does not turn
    Vec3 centre; ///< where that point is at time 0, seen from from.translation along the axes of the world, metres
};

/// The screw that leads from one pose to another by the shortest turn (Chasles): a turn about an axis, and a shift
/// along it. It does not depend on where the body has its origin; one that only turns about some axis does that. Poses
/// that are rigid only to 1e-4 count as the nearest that are. Throws InputError for others, and beyond 1e30 m.
RAYCONTACT_API RigidMotion screw_motion(const Pose& from, const Pose& to);

/// A point of the body moves straight from one pose to another, and the body turns about it by the shortest turn: what
/// a free body does that turns about a principal axis, if the point is its centre of mass. body_point: body frame,
/// metres. Throws InputError as screw_motion().
RAYCONTACT_API RigidMotion straight_motion(const Pose& from, const Pose& to, const Vec3& body_point = {});

/// A body that stays where it is. Throws InputError as screw_motion().
RAYCONTACT_API RigidMotion no_motion(const Pose& pose);

/// Where the body is at a time, by sine and cosine, whose last bit machines do not share.
RAYCONTACT_API Pose pose_at(const RigidMotion& motion, double time);

} // namespace raycontact
