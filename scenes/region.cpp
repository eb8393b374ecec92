// SPDX-License-Identifier: Apache-2.0
#include <scenes/region.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace raycontact::scenes {

namespace {

constexpr std::array<double Vec3::*, 3> axes{&Vec3::x, &Vec3::y, &Vec3::z};

bool holds(const Region& region, const Vec3& p) {
    return std::all_of(axes.begin(), axes.end(),
                       [&](auto axis) { return p.*axis >= region.low.*axis && p.*axis <= region.high.*axis; });
}

/// Whether the way from a point against gravity meets the region.
bool meets_above(const Region& region, const Vec3& gravity, const Vec3& p) {
    double from = 0, to = Region::inf;
    for (const auto axis : axes) {
        if (!std::isfinite(p.*axis)) return false;
        double near = region.low.*axis - p.*axis, far = region.high.*axis - p.*axis;
        if (gravity.*axis == 0) {
            if (near > 0 || far < 0) return false;
            continue;
        }
        const double up = -(gravity.*axis);
        near /= up, far /= up;
        if (near > far) std::swap(near, far);
        from = std::max(from, near), to = std::min(to, far);
    }
    return from <= to;
}

/// Of the lowest corner, along gravity.
double depth_of(const Region& region, const Vec3& gravity) {
    double depth = 0;
    for (const auto axis : axes) {
        const double g = gravity.*axis;
        if (g != 0) depth += g * (g < 0 ? region.low.*axis : region.high.*axis);
    }
    return depth;
}

} // namespace

void Region::include(const Vec3& point) {
    for (const auto axis : axes) {
        low.*axis = std::min(low.*axis, point.*axis);
        high.*axis = std::max(high.*axis, point.*axis);
    }
}

void Region::open_above(const Vec3& gravity) {
    for (const auto axis : axes) {
        if (gravity.*axis < 0) high.*axis = inf;
        if (gravity.*axis > 0) low.*axis = -inf;
    }
}

bool Region::has_ground(const Vec3& gravity) const {
    return std::any_of(axes.begin(), axes.end(), [&](auto axis) {
        const double g = gravity.*axis;
        return g != 0 && std::isfinite(g < 0 ? low.*axis : high.*axis);
    });
}

bool Region::is_below(const Vec3& gravity, const Vec3& p) const {
    if (holds(*this, p)) return false;
    return meets_above(*this, gravity, p)
           || gravity.x * p.x + gravity.y * p.y + gravity.z * p.z > depth_of(*this, gravity);
}

bool Region::has_left(const Vec3& gravity, const Vec3& p) const {
    return !meets_above(*this, gravity, p);
}

} // namespace raycontact::scenes
