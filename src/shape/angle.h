// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

namespace raycontact {

/// Arc tangent of x >= 0, to about 1e-15, from correctly rounded operations only: libm's differs between systems, and
/// vertex normals decide rays.
inline double portable_atan(double x) {
    constexpr double half_pi = 1.5707963267948966;
    if (x > 1) return half_pi - portable_atan(1 / x);
    // Three halvings bring the argument below 0.099, where ten terms of the series suffice.
    for (int i = 0; i < 3; ++i) x = x / (1 + std::sqrt(1 + x * x));
    const double x2 = x * x;
    double sum = 0;
    for (int k = 21; k >= 1; k -= 2) sum = 1.0 / k - x2 * sum;
    return 8 * x * sum;
}

/// Angle between two vectors, radians; 0 when one is zero (Kahan's formula: no loss near 0 or pi).
inline double angle_between(const Vec3& a, const Vec3& b) {
    const double la = length(a), lb = length(b);
    if (la == 0 || lb == 0) return 0;
    const Vec3 u = lb * a, v = la * b;
    const double apart = length(u - v), together = length(u + v);
    if (together == 0) return 3.141592653589793;
    return 2 * portable_atan(apart / together);
}

} // namespace raycontact
