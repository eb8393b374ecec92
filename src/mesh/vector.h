// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace raycontact {

/// By a rotation, its rows one after the other; and by its transpose.
inline Vec3 rotated(const std::array<double, 9>& r, const Vec3& a) {
    return {(r[0] * a.x + r[1] * a.y) + r[2] * a.z, (r[3] * a.x + r[4] * a.y) + r[5] * a.z,
            (r[6] * a.x + r[7] * a.y) + r[8] * a.z};
}
inline Vec3 rotated_back(const std::array<double, 9>& r, const Vec3& a) {
    return {(r[0] * a.x + r[3] * a.y) + r[6] * a.z, (r[1] * a.x + r[4] * a.y) + r[7] * a.z,
            (r[2] * a.x + r[5] * a.y) + r[8] * a.z};
}
inline Vec3 least(const Vec3& a, const Vec3& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 most(const Vec3& a, const Vec3& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline bool is_finite(const Vec3& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
/// Rises from 0 to 4 with the angle of (x, y), without a function that machines round differently; 0 of (0, 0).
inline double turn_of(double x, double y) {
    const double size = std::fabs(x) + std::fabs(y);
    if (size == 0) return 0;
    const double part = y / size; // of the quarters around (1, 0)
    return x < 0 ? 2 - part : y < 0 ? 4 + part : part;
}
inline double axis(const Vec3& a, std::size_t k) {
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

} // namespace raycontact
