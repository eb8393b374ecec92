// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <array>
#include <cstddef>

namespace raycontact {

/// Arc tangents of three numbers >= 0, to about 1e-15, from correctly rounded operations only: libm's differs between
/// systems, and vertex normals decide rays. Three side by side, since each is a chain of operations.
inline std::array<double, 3> portable_atan(const std::array<double, 3>& numbers) {
    constexpr double half_pi = 1.5707963267948966;
    std::array<double, 3> x, sum{};
    for (std::size_t i = 0; i < 3; ++i) x[i] = numbers[i] > 1 ? 1 / numbers[i] : numbers[i];
    // Three halvings bring the argument below 0.099, where ten terms of the series suffice.
    for (int halving = 0; halving < 3; ++halving)
        for (double& value : x) value = value / (1 + std::sqrt(1 + value * value));
    for (int k = 21; k >= 1; k -= 2)
        for (std::size_t i = 0; i < 3; ++i) sum[i] = 1.0 / k - x[i] * x[i] * sum[i];
    for (std::size_t i = 0; i < 3; ++i) {
        const double angle = 8 * x[i] * sum[i];
        sum[i] = numbers[i] > 1 ? half_pi - angle : angle;
    }
    return sum;
}

/// Angles of a triangle at its corners, radians; 0 where a side of length zero ends (Kahan's formula: no loss near 0
/// or pi).
inline std::array<double, 3> corner_angles(const std::array<Vec3, 3>& corners) {
    std::array<Vec3, 3> side; // from each corner to the next
    std::array<double, 3> size, ratio;
    for (std::size_t c = 0; c < 3; ++c) {
        side[c] = corners[(c + 1) % 3] - corners[c];
        size[c] = length(side[c]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t before = (c + 2) % 3;
        const Vec3 u = size[before] * side[c], v = size[c] * side[before]; // v leads to the corner
        const double apart = length(u + v), together = length(u - v);
        ratio[c] = size[c] == 0 || size[before] == 0 ? 0 : apart / together; // infinite where together is 0: pi
    }
    std::array<double, 3> angles = portable_atan(ratio);
    for (double& angle : angles) angle = 2 * angle;
    return angles;
}

} // namespace raycontact
