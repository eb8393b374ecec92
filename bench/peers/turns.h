// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/random.h>

#include <array>
#include <cmath>

namespace raycontact::bench {

using Quaternion = std::array<double, 4>; // w x y z

inline Quaternion times(const Quaternion& a, const Quaternion& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// In a ball, not too near its middle.
inline std::array<double, 3> random_direction(scenes::Random& random) {
    for (;;) {
        const double x = random.symmetric(), y = random.symmetric(), z = random.symmetric();
        const double square = x * x + y * y + z * z;
        if (square > 1 || square < 0.01) continue;
        const double length = std::sqrt(square);
        return {x / length, y / length, z / length};
    }
}

inline Quaternion random_rotation(scenes::Random& random) {
    for (;;) {
        const Quaternion q{random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric()};
        const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (square <= 1 && square > 0.01) return q;
    }
}

} // namespace raycontact::bench
