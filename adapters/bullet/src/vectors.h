// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <LinearMath/btVector3.h>

#include <cmath>

namespace raycontact::bullet {

inline Vec3 to_vec(const btVector3& v) {
    return {double(v.x()), double(v.y()), double(v.z())};
}

inline btVector3 to_bullet(const Vec3& v) {
    return btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z));
}

/// In double: a plane's height far from the origin needs it.
inline double dot_in_double(const btVector3& a, const btVector3& b) {
    return double(a.x()) * double(b.x()) + double(a.y()) * double(b.y()) + double(a.z()) * double(b.z());
}

/// A direction, from the body frame into the world.
inline Vec3 turned(const Pose& pose, const Vec3& v) {
    const auto& r = pose.rotation;
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
            r[6] * v.x + r[7] * v.y + r[8] * v.z};
}

} // namespace raycontact::bullet
