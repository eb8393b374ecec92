// SPDX-License-Identifier: Apache-2.0
#include <raycontact/rigid_motion.h>

#include "mesh/vector.h"
#include "query/checks.h"
#include "query/shape_pair.h"

#include <array>
#include <cmath>

namespace raycontact {

namespace {

using Rotation = std::array<double, 9>;

// The axis, as long as the angle, of at most half a turn. By the largest part of the quaternion, so that no angle is
// inaccurate (Shepperd 1978).
Vec3 rotation_vector(const Rotation& r) {
    const double trace = r[0] + r[4] + r[8];
    const Vec3 skew{r[7] - r[5], r[2] - r[6], r[3] - r[1]};
    double w = 0;
    Vec3 v;
    if (trace > 0) {
        w = 1 + trace;
        v = skew;
    } else if (r[0] >= r[4] && r[0] >= r[8]) {
        w = skew.x;
        v = {1 + r[0] - r[4] - r[8], r[1] + r[3], r[2] + r[6]};
    } else if (r[4] >= r[8]) {
        w = skew.y;
        v = {r[1] + r[3], 1 + r[4] - r[0] - r[8], r[5] + r[7]};
    } else {
        w = skew.z;
        v = {r[2] + r[6], r[5] + r[7], 1 + r[8] - r[0] - r[4]};
    }
    const double size = length(v);
    if (size == 0) return {};
    return (2 * std::atan2(w < 0 ? -size : size, std::fabs(w)) / size) * v;
}

/// Both ends of a motion, checked, and the turn between them.
struct Ends {
    Pose from, to;
    Vec3 turn;

    Ends(const Pose& first, const Pose& last) {
        check_placed(first, "first pose of a motion");
        check_placed(last, "last pose of a motion");
        from = nearest_rigid_pose(first);
        to = nearest_rigid_pose(last);
        if (from.rotation != to.rotation) turn = rotation_vector(product_of(to.rotation, inverse_of(from.rotation)));
    }
};

} // namespace

RigidMotion screw_motion(const Pose& from, const Pose& to) {
    const Ends ends(from, to);
    const Vec3 apart = ends.to.translation - ends.from.translation;
    const double angle = length(ends.turn);
    if (angle < 1e-100) return {ends.from, apart, {}, {}}; // its axis would be too far away for a double
    const Vec3 axis = (1 / angle) * ends.turn;
    const Vec3 along = dot(apart, axis) * axis, across = apart - along;
    const Vec3 centre = 0.5 * across + (0.5 / std::tan(0.5 * angle)) * cross(axis, across);
    return {ends.from, along, ends.turn, centre};
}

RigidMotion straight_motion(const Pose& from, const Pose& to, const Vec3& body_point) {
    const Ends ends(from, to);
    check_place(body_point, "straight_motion: the point of the body");
    const Vec3 centre = rotated(ends.from.rotation, body_point);
    const Vec3 turned = rotated(ends.to.rotation, body_point) - centre;
    return {ends.from, (ends.to.translation - ends.from.translation) + turned, ends.turn, centre};
}

RigidMotion no_motion(const Pose& pose) {
    check_placed(pose, "pose of a motion");
    return {nearest_rigid_pose(pose), {}, {}, {}};
}

// What turns is taken off from where it was, so that nothing is lost where the centre is far away.
Pose pose_at(const RigidMotion& motion, double time) {
    Pose pose = motion.from;
    pose.translation = pose.translation + time * motion.velocity;
    const double rate = length(motion.angular_velocity);
    if (rate == 0 || time == 0) return pose;
    const Vec3 axis = (1 / rate) * motion.angular_velocity;
    const double half = std::sin(0.5 * rate * time), sine = std::sin(rate * time), versine = 2 * half * half;
    const auto turned = [&](const Vec3& v) { // less v
        const Vec3 once = cross(axis, v);
        return sine * once + versine * cross(axis, once);
    };
    pose.translation = pose.translation - turned(motion.centre);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 column{motion.from.rotation[k], motion.from.rotation[3 + k], motion.from.rotation[6 + k]};
        const Vec3 now = column + turned(column);
        pose.rotation[k] = now.x;
        pose.rotation[3 + k] = now.y;
        pose.rotation[6 + k] = now.z;
    }
    return pose;
}

} // namespace raycontact
