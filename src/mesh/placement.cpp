// SPDX-License-Identifier: Apache-2.0
#include "mesh/placement.h"

#include <array>
#include <cmath>

namespace raycontact {

std::pair<Pose, Placement> PartScales::split(const Placement& placement) {
    Pose pose;
    pose.translation = placement.origin;
    const auto& [x, y, z, origin] = placement;
    const double size = std::cbrt(dot(x, cross(y, z)));
    // Files have such numbers in float32.
    constexpr double alike = 1e-5;
    const auto is_one = [&](double square) { return std::fabs(square / (size * size) - 1) < alike; };
    const auto is_none = [&](double product) { return std::fabs(product / (size * size)) < alike; };
    if (!(size > 0) || !is_one(dot(x, x)) || !is_one(dot(y, y)) || !is_one(dot(z, z)) || !is_none(dot(x, y))
        || !is_none(dot(y, z)) || !is_none(dot(z, x)))
        return {pose, {x, y, z, {}}};
    const double scale = shared(size);
    const Vec3 &u = (1 / size) * x, &v = (1 / size) * y, &w = (1 / size) * z;
    pose = pose_from_matrix(
        std::array{u.x, v.x, w.x, origin.x, u.y, v.y, w.y, origin.y, u.z, v.z, w.z, origin.z, 0.0, 0.0, 0.0, 1.0});
    return {pose, {{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, {}}};
}

double PartScales::shared(double size) {
    constexpr double alike = 1e-6;
    const auto known = scales_.lower_bound((1 - alike) * size);
    if (known != scales_.end() && *known <= (1 + alike) * size) return *known;
    const double unit = std::pow(10.0, std::floor(std::log10((1 + alike) * size)) - 7);
    return *scales_.insert(std::round(size / unit) * unit).first;
}

} // namespace raycontact
