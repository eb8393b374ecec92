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

/// A direction, from the body frame into the world and back.
inline Vec3 turned(const Pose& pose, const Vec3& v) {
    const auto& r = pose.rotation;
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
            r[6] * v.x + r[7] * v.y + r[8] * v.z};
}
inline Vec3 turned_back(const Pose& pose, const Vec3& v) {
    const auto& r = pose.rotation;
    return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
            r[2] * v.x + r[5] * v.y + r[8] * v.z};
}

/// Where two lines come closest, in parts of their directions: a + first x along, p + second x edge.
struct ClosestOnLines {
    double first, second;
};
/// square: |along x edge|^2, which is not 0: they are not parallel.
inline ClosestOnLines closest_on_lines(const Vec3& a, const Vec3& along, const Vec3& p, const Vec3& edge,
                                       double square) {
    const Vec3 between = a - p;
    const double mixed = dot(along, edge);
    return {(mixed * dot(edge, between) - length2(edge) * dot(along, between)) / square,
            (length2(along) * dot(edge, between) - mixed * dot(along, between)) / square};
}

} // namespace raycontact::bullet
