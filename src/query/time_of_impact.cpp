// SPDX-License-Identifier: Apache-2.0
#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/impacts.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace raycontact {

namespace {

// The least that can be told apart on the way, in errors of rough points.
constexpr double roundings = 64;

void check_length(double metres, const char* what) {
    if (!(metres >= 0 && std::isfinite(metres)))
        throw InputError(std::string("time of impact: the ") + what + " is negative or not finite; give metres");
}

/// The piece of a path that begins at a pose.
RigidMotion piece_of(std::span<const Pose> path, std::size_t number) {
    return path.size() == 1 ? screw_motion(path[0], path[0]) : screw_motion(path[number], path[number + 1]);
}

} // namespace

RigidMotion checked_motion(const RigidMotion& given, const char* what) {
    check_placed(given.from, what);
    for (const Vec3& part : {given.velocity, given.angular_velocity, given.centre}) check_place(part, what);
    RigidMotion motion = given;
    motion.from = nearest_rigid_pose(given.from);
    return motion;
}

Nearness checked_nearness(const Shape& a, const Shape& b, double distance, double tolerance) {
    check_length(distance, "distance");
    check_length(tolerance, "tolerance");
    return {distance, tolerance > 0 ? tolerance : 1e-7 * std::min(a.data().diagonal, b.data().diagonal)};
}

std::optional<Impact> impact_at_start(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                      const Nearness& near) {
    const auto found = distance(a, pose_a, b, pose_b, near.distance + near.tolerance);
    if (!found) return std::nullopt;
    const Vec3 normal = found->distance > 0 ? unit(found->point_b - found->point_a) : Vec3{};
    return Impact{0, found->distance, found->point_a, found->point_b, normal, found->triangle_a, found->triangle_b};
}

std::optional<Impact> impact_on_the_way(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                        const RigidMotion& motion_b, const Nearness& given, double begin,
                                        double latest) {
    const MovingPair pair(a, motion_a, b, motion_b);
    Nearness near = given;
    for (const double time : {0.0, 1.0})
        near.tolerance = std::max(near.tolerance, roundings * pair.at(time).pair.error());
    const auto met = first_meeting(pair, near, begin, latest);
    if (!met) return std::nullopt;
    const auto moment = pair.at(met->time);
    const Vec3 apart = rotated(pose_at(motion_b, met->time).rotation, met->point_b - met->point_a);
    return Impact{met->time,
                  length(apart),
                  moment.pair.to_world(met->point_a),
                  moment.pair.to_world(met->point_b),
                  unit(apart),
                  a.triangle_index()[met->a],
                  b.triangle_index()[met->b]};
}

std::optional<Impact> time_of_impact(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                     const RigidMotion& motion_b, double distance, double tolerance) {
    const FloatEnvironment environment;
    const Nearness near = checked_nearness(a, b, distance, tolerance);
    const RigidMotion sound_a = checked_motion(motion_a, "motion of the first mesh");
    const RigidMotion sound_b = checked_motion(motion_b, "motion of the second mesh");
    if (const auto impact = impact_at_start(a, motion_a.from, b, motion_b.from, near)) return impact;
    return impact_on_the_way(a, sound_a, b, sound_b, near);
}

std::optional<Impact> time_of_impact(const Shape& a, const Pose& from_a, const Pose& to_a, const Shape& b,
                                     const Pose& from_b, const Pose& to_b, double distance, double tolerance) {
    return time_of_impact(a, std::array{from_a, to_a}, b, std::array{from_b, to_b}, distance, tolerance);
}

std::optional<Impact> time_of_impact(const Shape& a, std::span<const Pose> path_a, const Shape& b,
                                     std::span<const Pose> path_b, double distance, double tolerance) {
    const FloatEnvironment environment;
    const Nearness near = checked_nearness(a, b, distance, tolerance);
    if (path_a.empty() || path_b.empty()) throw InputError("time of impact: a path has no pose; give one at least");
    if (path_a.size() > 1 && path_b.size() > 1 && path_a.size() != path_b.size())
        throw InputError("time of impact: the paths have " + std::to_string(path_a.size()) + " and "
                         + std::to_string(path_b.size()) + " poses; give as many of each, or one of what stays");
    for (const auto& [path, what] : {std::pair{path_a, "pose of the first mesh"}, {path_b, "pose of the second mesh"}})
        for (const Pose& pose : path) check_placed(pose, what);

    if (const auto impact = impact_at_start(a, path_a[0], b, path_b[0], near)) return impact;
    for (std::size_t number = 0; number + 1 < std::max(path_a.size(), path_b.size()); ++number)
        if (auto impact = impact_on_the_way(a, piece_of(path_a, number), b, piece_of(path_b, number), near)) {
            impact->time += double(number);
            return impact;
        }
    return std::nullopt;
}

} // namespace raycontact
