// SPDX-License-Identifier: Apache-2.0
#include "pairs/displacement.h"

#include "mesh/vector.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

double shear_bound(const Pose& pose) {
    const auto& r = pose.rotation;
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double product = (r[i] * r[j] + r[3 + i] * r[3 + j]) + r[6 + i] * r[6 + j] - (i == j ? 1 : 0);
            sum += (i == j ? 1 : 2) * product * product;
        }
    return std::sqrt(sum);
}

double turn_bound(const Pose& from, const Pose& to, double shear) {
    double sum = 0;
    for (std::size_t i = 0; i < 9; ++i) {
        const double change = to.rotation[i] - from.rotation[i];
        sum += change * change;
    }
    // With R = O + E, O a rotation and ||E|| <= shear, the two E cost (2 / sqrt(2) + 2) shear at most.
    const double frobenius = std::sqrt(sum);
    return std::min(frobenius, frobenius * 0.70710678118654757 + 3.4143 * shear);
}

Pose inverse_pose(const Pose& pose) {
    const auto& r = pose.rotation;
    const Vec3& t = pose.translation;
    Pose inverse;
    inverse.rotation = {r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]};
    inverse.translation = {-((r[0] * t.x + r[3] * t.y) + r[6] * t.z), -((r[1] * t.x + r[4] * t.y) + r[7] * t.z),
                           -((r[2] * t.x + r[5] * t.y) + r[8] * t.z)};
    return inverse;
}

double displacement_bound(const Pose& from, const Pose& to, double reach, double shear) {
    return length(to.translation - from.translation) + turn_bound(from, to, shear) * reach;
}

} // namespace raycontact
