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

double displacement_bound(const Pose& from, const Pose& to, double reach, double shear) {
    return length(to.translation - from.translation) + turn_bound(from, to, shear) * reach;
}

PairPlace place_pair(const Pose& first, const Pose& second, double shear) {
    return {relative_pose(second, first), rotated_back(first.rotation, second.translation - first.translation), shear};
}

std::array<double, 2> displacement_bounds(const PairPlace& from, const PairPlace& to, double reach_first,
                                          double reach_second) {
    const double turn = turn_bound(from.pose, to.pose, std::max(from.shear, to.shear));
    return {length(to.pose.translation - from.pose.translation) + turn * reach_first,
            length(to.back - from.back) + turn * reach_second};
}

} // namespace raycontact
