// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <cmath>

// Double-precision vectors for the reference alone: nothing here is shared with the library under test.
namespace raycontact::reference {

inline double component(const Vec3& a, int axis) {
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

inline Vec3 rotate(const Pose& p, const Vec3& v) {
    const auto& r = p.rotation;
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
            r[6] * v.x + r[7] * v.y + r[8] * v.z};
}
inline Vec3 rotate_back(const Pose& p, const Vec3& v) {
    const auto& r = p.rotation;
    return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
            r[2] * v.x + r[5] * v.y + r[8] * v.z};
}

} // namespace raycontact::reference
