// SPDX-License-Identifier: Apache-2.0
#include <tests/stacks/overlap.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

namespace {

Vec3 column_of(const Pose& pose, std::size_t k) {
    return {pose.rotation[k], pose.rotation[3 + k], pose.rotation[6 + k]};
}

double half_width(const Vec3& size, const Pose& pose, const Vec3& axis) {
    return (size.x * std::fabs(dot(column_of(pose, 0), axis)) + size.y * std::fabs(dot(column_of(pose, 1), axis))
            + size.z * std::fabs(dot(column_of(pose, 2), axis)))
           / 2;
}

} // namespace

double box_overlap(const Vec3& size_a, const Pose& a, const Vec3& size_b, const Pose& b) {
    const Vec3 between{b.translation.x - a.translation.x, b.translation.y - a.translation.y,
                       b.translation.z - a.translation.z};
    double least = 1e300;
    const auto ask = [&](const Vec3& axis) {
        const double length = std::sqrt(dot(axis, axis));
        if (length < 1e-6) return; // edges that are parallel: the faces have this axis
        const Vec3 unit{axis.x / length, axis.y / length, axis.z / length};
        least =
            std::min(least, half_width(size_a, a, unit) + half_width(size_b, b, unit) - std::fabs(dot(between, unit)));
    };
    for (std::size_t i = 0; i < 3; ++i) {
        ask(column_of(a, i));
        ask(column_of(b, i));
        for (std::size_t k = 0; k < 3; ++k) ask(cross(column_of(a, i), column_of(b, k)));
    }
    return std::max(0.0, least);
}

} // namespace raycontact::scenes
