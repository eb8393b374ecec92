// SPDX-License-Identifier: Apache-2.0
#include "broadphase/world_box.h"

#include <cmath>

namespace raycontact {

Box world_box(const Box& own, const Pose& pose, double grow) {
    const auto& r = pose.rotation;
    const Vec3 half = 0.5 * (own.high - own.low) + Vec3{grow, grow, grow};
    const Vec3 c = transform_point(pose, own.middle());
    // A billionth of the box covers the rounding of this very computation.
    const double slack = 1e-9 * (half.x + half.y + half.z) + 1e-15 * (std::fabs(c.x) + std::fabs(c.y) + std::fabs(c.z));
    const Vec3 e{std::fabs(r[0]) * half.x + std::fabs(r[1]) * half.y + std::fabs(r[2]) * half.z + slack,
                 std::fabs(r[3]) * half.x + std::fabs(r[4]) * half.y + std::fabs(r[5]) * half.z + slack,
                 std::fabs(r[6]) * half.x + std::fabs(r[7]) * half.y + std::fabs(r[8]) * half.z + slack};
    return {c - e, c + e};
}

} // namespace raycontact
