// SPDX-License-Identifier: Apache-2.0
#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/impacts.h"
#include "query/placed_round.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace raycontact {

namespace {

/// By unit of time; some microseconds each.
constexpr double most_radians = 1e6;

/// The least that can be told apart on the way, metres: some errors of rough points, and of poses between others.
double rounding_at(const MovingPair& pair, double time) {
    const auto size = [&](Side side) { return length(pose_at(pair.motion(side), time).translation); };
    return 64 * pair.at(time).pair.error() + 4e-15 * (size(Side::a) + size(Side::b));
}

void check_length(double metres, const char* what) {
    if (!(metres >= 0 && std::isfinite(metres)))
        throw InputError(std::string("time of impact: the ") + what + " is negative or not finite; give metres");
}

/// What turns about its middle, or its axis, alone does not turn for others: its core stays where it is.
RigidMotion without_rolling(const Shape& shape, RigidMotion motion) {
    const Round* round = shape.round();
    if (round == nullptr) return motion;
    const Vec3 from = rotated(motion.from.rotation, round->from), to = rotated(motion.from.rotation, round->to);
    const auto stays = [&](const Vec3& point) {
        return cross(motion.angular_velocity, point - motion.centre) == Vec3{};
    };
    if (stays(from) && stays(to)) motion.angular_velocity = {};
    return motion;
}

/// What a clearance may be off, metres. Throws InputError as checked_nearness().
double coarse_tolerance(const Shape& a, const Shape& b, double tolerance) {
    const double fine = checked_nearness(a, b, 0, tolerance).tolerance;
    return tolerance > 0 ? fine : 1000 * fine;
}

/// Two shapes and how they move, a unit of time after the other; checked.
class Course {
public:
    Course(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b)
        : a_(a), b_(b), start_a_(motion_a.from),
          start_b_(motion_b.from), pieces_{{checked_motion(motion_a, "motion of the first mesh"),
                                            checked_motion(motion_b, "motion of the second mesh")}} {}

    Course(const Shape& a, std::span<const Pose> path_a, const Shape& b, std::span<const Pose> path_b) : a_(a), b_(b) {
        if (path_a.empty() || path_b.empty()) throw InputError("paths: one has no pose; give one at least");
        if (path_a.size() > 1 && path_b.size() > 1 && path_a.size() != path_b.size())
            throw InputError("paths: they have " + std::to_string(path_a.size()) + " and "
                             + std::to_string(path_b.size()) + " poses; give as many of each, or one of what stays");
        for (const Pose& pose : path_a) check_placed(pose, "pose of the first mesh");
        for (const Pose& pose : path_b) check_placed(pose, "pose of the second mesh");
        start_a_ = path_a[0];
        start_b_ = path_b[0];
        const auto piece = [](std::span<const Pose> path, std::size_t number) {
            return path.size() == 1 ? no_motion(path[0]) : screw_motion(path[number], path[number + 1]);
        };
        const std::size_t count = std::max({path_a.size(), path_b.size(), std::size_t{2}}) - 1;
        for (std::size_t number = 0; number < count; ++number)
            pieces_.emplace_back(piece(path_a, number), piece(path_b, number));
    }

    /// after: a time until which they are not near.
    std::optional<Impact> first_impact(const Nearness& near, double after = 0) const {
        if (after == 0)
            if (const auto impact = impact_at_start(a_, start_a_, b_, start_b_, near)) return impact;
        for (auto number = static_cast<std::size_t>(after); number < pieces_.size(); ++number) {
            const auto& [motion_a, motion_b] = pieces_[number];
            const double begin = std::max(after - double(number), 0.0);
            if (auto impact = impact_on_the_way(a_, motion_a, b_, motion_b, near, begin)) {
                impact->time += double(number);
                return impact;
            }
        }
        return std::nullopt;
    }

    /// Goes down from where they are nearer than anywhere before, until they are nowhere nearer by the tolerance.
    std::optional<PathClearance> clearance(double max, double tolerance) const {
        if (const auto met = first_impact(checked_nearness(a_, b_, 0, 0)))
            return PathClearance{
                {met->distance, met->point_a, met->point_b, met->triangle_a, met->triangle_b}, met->time, true};
        PathClearance least;
        double after = 0; // until then they are not nearer than what was looked for last
        if (std::isfinite(max)) {
            const auto within = first_impact({max, 0.25 * tolerance});
            if (!within) return std::nullopt;
            after = within->time;
            least = descend(at(after));
        } else {
            least = at(0);
            for (std::size_t number = 1; number <= pieces_.size(); ++number) least = nearer(least, at(double(number)));
        }
        while (least.distance > tolerance) {
            const auto found = first_impact({least.distance - tolerance, 0.25 * tolerance}, after);
            if (!found) break;
            after = found->time;
            const PathClearance there = at(after);
            if (!(there.distance < least.distance)) break; // but for rounding
            least = descend(there);
        }
        return least.distance <= max ? std::optional(least) : std::nullopt;
    }

private:
    PathClearance at(double time) const {
        const double number = std::min(std::floor(time), double(pieces_.size() - 1));
        const auto& [motion_a, motion_b] = pieces_[static_cast<std::size_t>(number)];
        const Pose pose_a = pose_at(motion_a, time - number), pose_b = pose_at(motion_b, time - number);
        return {*raycontact::distance(a_, pose_a, b_, pose_b), time};
    }
    static const PathClearance& nearer(const PathClearance& one, const PathClearance& other) {
        return other.distance < one.distance ? other : one;
    }

    /// A place near where a distance that falls with time is least: by longer and longer steps past it, and then by
    /// parts of the golden section.
    PathClearance descend(PathClearance from) const {
        const double end = double(pieces_.size());
        PathClearance low = from, high = from;
        for (double step = 1.0 / 256; high.time < end; step *= 2) {
            low = from;
            from = high;
            high = at(std::min(from.time + step, end));
            if (high.distance >= from.distance) break;
        }
        PathClearance least = nearer(from, high);
        constexpr double section = 0.381966;
        double begin = low.time, finish = high.time;
        for (int round = 0; round < 24; ++round) {
            const bool after = finish - least.time > least.time - begin;
            const double time = least.time + section * ((after ? finish : begin) - least.time);
            const PathClearance there = at(time);
            if (there.distance < least.distance) {
                (after ? begin : finish) = least.time;
                least = there;
            } else {
                (after ? finish : begin) = time;
            }
        }
        return least;
    }

    const Shape &a_, &b_;
    Pose start_a_, start_b_; ///< as they were given
    std::vector<std::pair<RigidMotion, RigidMotion>> pieces_;
};

} // namespace

RigidMotion checked_motion(const RigidMotion& given, const char* what) {
    check_placed(given.from, what);
    for (const Vec3& part : {given.velocity, given.angular_velocity, given.centre}) check_place(part, what);
    if (!(length(given.angular_velocity) <= most_radians))
        throw InputError(std::string(what) + ": turns by more than a million radians; give a shorter time");
    RigidMotion motion = given;
    motion.from = nearest_rigid_pose(given.from);
    return motion;
}

Nearness checked_nearness(const Shape& a, const Shape& b, double distance, double tolerance) {
    check_length(distance, "distance");
    check_length(tolerance, "tolerance");
    return {distance, tolerance > 0 ? tolerance : 1e-7 * std::min(a.data().diagonal, b.data().diagonal)};
}

Vec3 normal_between(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, const Distance& apart) {
    if (const Round* round = a.round()) return PlacedRound(*round, pose_a).nearest(apart.point_b).outward;
    if (const Round* round = b.round()) return -PlacedRound(*round, pose_b).nearest(apart.point_a).outward;
    return unit(apart.point_b - apart.point_a);
}

std::optional<Impact> impact_at_start(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                      const Nearness& near) {
    const auto found = distance(a, pose_a, b, pose_b, near.distance + near.tolerance);
    if (!found) return std::nullopt;
    const Vec3 normal = found->distance > 0 ? normal_between(a, pose_a, b, pose_b, *found) : Vec3{};
    return Impact{0, found->distance, found->point_a, found->point_b, normal, found->triangle_a, found->triangle_b};
}

std::optional<Impact> impact_on_the_way(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                        const RigidMotion& motion_b, const Nearness& given, double begin,
                                        double latest) {
    const MovingPair pair(a, without_rolling(a, motion_a), b, without_rolling(b, motion_b));
    const double radius_a = radius_of(queried(a)), radius_b = radius_of(queried(b));
    Nearness near = given;
    near.distance += radius_a + radius_b;
    for (const double time : {0.0, 1.0}) near.tolerance = std::max(near.tolerance, rounding_at(pair, time));
    const auto met = first_meeting(pair, near, begin, latest);
    if (!met) return std::nullopt;
    const auto moment = pair.at(met->time);
    const Vec3 apart = rotated(pose_at(pair.motion(Side::b), met->time).rotation, met->point_b - met->point_a);
    return Impact{met->time,
                  std::max(length(apart) - radius_a - radius_b, 0.0),
                  moment.pair.to_world(met->point_a) + radius_a * unit(apart),
                  moment.pair.to_world(met->point_b) - radius_b * unit(apart),
                  unit(apart),
                  queried(a).mesh.triangle_index[met->a],
                  queried(b).mesh.triangle_index[met->b]};
}

std::optional<Impact> time_of_impact(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                     const RigidMotion& motion_b, double distance, double tolerance) {
    const FloatEnvironment environment;
    return Course(a, motion_a, b, motion_b).first_impact(checked_nearness(a, b, distance, tolerance));
}

std::optional<Impact> time_of_impact(const Shape& a, const Pose& from_a, const Pose& to_a, const Shape& b,
                                     const Pose& from_b, const Pose& to_b, double distance, double tolerance) {
    return time_of_impact(a, std::array{from_a, to_a}, b, std::array{from_b, to_b}, distance, tolerance);
}

std::optional<Impact> time_of_impact(const Shape& a, std::span<const Pose> path_a, const Shape& b,
                                     std::span<const Pose> path_b, double distance, double tolerance) {
    const FloatEnvironment environment;
    return Course(a, path_a, b, path_b).first_impact(checked_nearness(a, b, distance, tolerance));
}

std::optional<PathClearance> path_clearance(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                            const RigidMotion& motion_b, double max, double tolerance) {
    const FloatEnvironment environment;
    check_reach(max, "clearance");
    return Course(a, motion_a, b, motion_b).clearance(max, coarse_tolerance(a, b, tolerance));
}

std::optional<PathClearance> path_clearance(const Shape& a, std::span<const Pose> path_a, const Shape& b,
                                            std::span<const Pose> path_b, double max, double tolerance) {
    const FloatEnvironment environment;
    check_reach(max, "clearance");
    return Course(a, path_a, b, path_b).clearance(max, coarse_tolerance(a, b, tolerance));
}

} // namespace raycontact
