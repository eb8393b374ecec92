// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <LinearMath/btVector3.h>

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

/// Where two lines come closest, in parts of their directions: a + first x along, p + second x edge.
struct ClosestOnLines {
    btScalar first, second;
};
/// square: (|along| |edge|)^2 - (along . edge)^2, which is not 0: they are not parallel.
inline ClosestOnLines closest_on_lines(const btVector3& a, const btVector3& along, const btVector3& p,
                                       const btVector3& edge, btScalar square) {
    const btVector3 between = a - p;
    const btScalar mixed = along.dot(edge);
    return {(mixed * edge.dot(between) - edge.length2() * along.dot(between)) / square,
            (along.length2() * edge.dot(between) - mixed * along.dot(between)) / square};
}

} // namespace raycontact::bullet
