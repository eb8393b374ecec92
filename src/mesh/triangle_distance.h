// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <algorithm>

namespace raycontact {

/// Squared distance of a point from a segment; from its beginning if it has no length.
inline double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a, from = p - a;
    const double length2 = dot(along, along);
    const double part = length2 > 0 ? std::clamp(dot(from, along) / length2, 0.0, 1.0) : 0.0;
    const Vec3 apart = from - part * along;
    return dot(apart, apart);
}

/// Whether a triangle's normal is accurate to some 1e-10. Of a narrower one only the edges count.
inline bool has_plane(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, normal = cross(ab, ac);
    return dot(normal, normal) > 1e-12 * dot(ab, ab) * dot(ac, ac);
}

/// Squared distance of a point from a triangle: from its plane where the point projects inside, else from the nearest
/// edge. For needles it may be too large by a millionth of their length.
inline double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = cross(b - a, c - a);
    const double size2 = dot(normal, normal);
    if (has_plane(a, b, c)) {
        const double ab = dot(normal, cross(b - a, p - a));
        const double bc = dot(normal, cross(c - b, p - b));
        const double ca = dot(normal, cross(a - c, p - c));
        if (ab >= 0 && bc >= 0 && ca >= 0) {
            const double height = dot(normal, p - a);
            return height * height / size2;
        }
    }
    return std::min({squared_distance(p, a, b), squared_distance(p, b, c), squared_distance(p, c, a)});
}

} // namespace raycontact
