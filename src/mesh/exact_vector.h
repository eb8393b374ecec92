// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/dyadic.h"
#include "mesh/vector.h"

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

/// Along its normal, of whatever length, and right to rounding: of a needle a cross product in double says anything.
/// Zero of a triangle without an area.
inline Vec3 along_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 p = b - a, q = c - a, rough = cross(p, q);
    constexpr double flattest = 0.01;
    if (length(rough) > flattest * length(p) * length(q)) return rough;
    const ExactVec3 exact = area_normal(a, b, c);
    const Dyadic size = abs(exact.x) + abs(exact.y) + abs(exact.z);
    if (size.sign() == 0) return {};
    return {ratio(exact.x, size), ratio(exact.y, size), ratio(exact.z, size)};
}

} // namespace raycontact
