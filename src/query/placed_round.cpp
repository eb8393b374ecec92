// SPDX-License-Identifier: Apache-2.0
#include "query/placed_round.h"

#include "mesh/vector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Where a line is in a convex body, in lengths of its direction; in none it begins after its end.
struct Stretch {
    double begin = infinite, end = -infinite;

    bool is_empty() const { return !(begin <= end); }
    void join(const Stretch& other) {
        if (other.is_empty()) return;
        *this = {std::min(begin, other.begin), std::max(end, other.end)};
    }
    void cut(const Stretch& other) { *this = {std::max(begin, other.begin), std::min(end, other.end)}; }
};

/// A line by a point and a unit direction.
struct Line {
    Vec3 point, direction;
};

Stretch in_ball(const Line& line, const Vec3& middle, double radius) {
    const Vec3 off = line.point - middle;
    const double along = dot(off, line.direction);
    const double square = radius * radius - length2(off - along * line.direction);
    if (!(square >= 0)) return {};
    return {-along - std::sqrt(square), -along + std::sqrt(square)};
}

Stretch in_tube(const Line& line, const Vec3& from, const Vec3& to, double radius) {
    const Vec3 axis = unit(to - from), off = line.point - from;
    if (axis == Vec3{}) return {};
    const double rise = dot(line.direction, axis), begin = dot(off, axis);
    const Vec3 way = line.direction - rise * axis, beside = off - begin * axis;
    const double slope = length2(way), nearest = slope > 0 ? -dot(beside, way) / slope : 0;
    const double square = radius * radius - length2(beside + nearest * way);
    if (!(square >= 0)) return {};
    Stretch stretch{-infinite, infinite};
    if (slope > 0) stretch = {nearest - std::sqrt(square / slope), nearest + std::sqrt(square / slope)};
    const double size = length(to - from);
    if (rise == 0) return begin >= 0 && begin <= size ? stretch : Stretch{};
    stretch.cut({std::min(-begin / rise, (size - begin) / rise), std::max(-begin / rise, (size - begin) / rise)});
    return stretch;
}

/// At right angles to a direction; of none any.
Vec3 beside(const Vec3& axis) {
    const Vec3 side = unit(cross(axis, std::fabs(axis.x) <= 0.5 * length(axis) ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    return side == Vec3{} ? Vec3{0, 0, 1} : side;
}

} // namespace

PlacedRound::PlacedRound(const Round& round, const Pose& pose)
    : about_(pose.translation), from_(rotated(pose.rotation, round.from)), to_(rotated(pose.rotation, round.to)),
      radius_(round.radius) {}

PlacedRound::Nearest PlacedRound::nearest(const Vec3& point) const {
    const Vec3 off = point - about_ - from_, along = to_ - from_;
    const double square = length2(along);
    const Vec3 part = square > 0 ? std::clamp(dot(off, along) / square, 0.0, 1.0) * along : Vec3{};
    const double metres = length(off - part);
    const Vec3 outward = metres > 1e-150 ? (off - part) / metres : beside(along);
    return {metres - radius_, about_ + (from_ + part + radius_ * outward), outward};
}

// A line that leaves a convex body does not come back: what it is in of the parts is what it is in of the whole.
std::optional<double> PlacedRound::meet(const Vec3& origin, const Vec3& direction) const {
    const Vec3 off = origin - about_ - 0.5 * (from_ + to_);
    const double before = -dot(off, direction); // to where it is nearest to the middle, where rounding is least
    const Line line{off + before * direction, direction};
    const Vec3 half = 0.5 * (to_ - from_);
    Stretch stretch;
    stretch.join(in_tube(line, -half, half, radius_));
    stretch.join(in_ball(line, -half, radius_));
    stretch.join(in_ball(line, half, radius_));
    if (stretch.is_empty()) return std::nullopt;
    const double rounding = 1e-15 * (length(off) + length(half) + radius_);
    for (const double distance : {before + stretch.begin, before + stretch.end})
        if (distance >= -rounding) return std::max(distance, 0.0);
    return std::nullopt;
}

} // namespace raycontact
