// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/dyadic.h"

#include <raycontact/pose.h>

#include <cstddef>
#include <utility>

namespace raycontact {

/// As Vec3, without any rounding.
struct ExactVec3 {
    Dyadic x, y, z;

    ExactVec3() = default;
    ExactVec3(Dyadic ax, Dyadic ay, Dyadic az) : x(std::move(ax)), y(std::move(ay)), z(std::move(az)) {}
    ExactVec3(const Vec3& v) : x(v.x), y(v.y), z(v.z) {} // NOLINT(google-explicit-constructor): each is one
};

inline ExactVec3 operator-(const ExactVec3& a, const ExactVec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Dyadic dot(const ExactVec3& a, const ExactVec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline ExactVec3 cross(const ExactVec3& a, const ExactVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline const Dyadic& axis(const ExactVec3& a, std::size_t k) {
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/// Of the triangle a, b, c, twice its area long.
inline ExactVec3 area_normal(const ExactVec3& a, const ExactVec3& b, const ExactVec3& c) {
    return cross(b - a, c - a);
}

} // namespace raycontact
