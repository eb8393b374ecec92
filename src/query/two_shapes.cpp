// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/inside.h"
#include "query/placed_round.h"
#include "query/shared_point.h"
#include "query/surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

/// A vertex of one shape inside the other.
struct Inner {
    std::uint32_t vertex;
    bool of_a;
    Vec3 point; ///< world frame
};

std::optional<Inner> inner_vertex(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                  const ShapePair& pair) {
    if (const auto vertex = vertex_inside(pair))
        return Inner{*vertex, true, transform_point(pose_a, queried(a).file_vertex(*vertex))};
    if (const auto vertex = vertex_inside(ShapePair(b, pose_b, a, pose_a)))
        return Inner{*vertex, false, transform_point(pose_b, queried(b).file_vertex(*vertex))};
    return std::nullopt;
}

Vec3 point_of(const MeetingTriangles& found, const ShapePair& pair) {
    return pair.to_world(shared_point(pair.triangle_of_a(found.a), pair.b().triangle(found.b)));
}

std::uint32_t in_file(const Shape& shape, std::uint32_t triangle) {
    return triangle == Shape::no_triangle ? triangle : queried(shape).mesh.triangle_index[triangle];
}

/// Where two bodies are nearest of which one is round, as distance() tells it: by their cores, of which they are all
/// that is within the radii.
std::optional<Distance> distance_of_round(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                          double max) {
    const ShapePair pair(a, pose_a, b, pose_b);
    const double radius_a = radius_of(pair.a()), radius_b = radius_of(pair.b().shape());
    const auto closest = closest_triangles(pair, max + pair.radius());
    const Vec3 apart = closest ? rotated(pose_b.rotation, closest->point_b - closest->point_a) : Vec3{};
    const double metres = length(apart) - pair.radius();
    if (!closest || metres > 0)
        if (const auto inner = inner_vertex(a, pose_a, b, pose_b, pair)) return Distance{0, inner->point, inner->point};
    if (!closest || metres > max) return std::nullopt;
    const Vec3 way = unit(apart), from = pair.to_world(closest->point_a);
    const auto found = [&](double to_a, double to_b) {
        return Distance{std::max(metres, 0.0), from + to_a * way, from + to_b * way, in_file(a, closest->a),
                        in_file(b, closest->b)};
    };
    if (metres > 0) return found(radius_a, radius_a + metres);
    // In the middle of what both have of the way.
    const double between = 0.5 * (std::max(length(apart) - radius_b, 0.0) + std::min(radius_a, length(apart)));
    return found(between, between);
}

bool is_round(const Shape& a, const Shape& b) {
    return a.round() != nullptr || b.round() != nullptr;
}

} // namespace

std::optional<Vec3> common_point(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const FloatEnvironment environment;
    check_placed(pose_a, "pose of the first mesh");
    check_placed(pose_b, "pose of the second mesh");
    if (is_round(a, b)) {
        const auto shared = distance_of_round(a, pose_a, b, pose_b, 0);
        return shared ? std::optional(shared->point_a) : std::nullopt;
    }
    const ShapePair pair(a, pose_a, b, pose_b);
    if (const auto found = meeting_triangles(pair)) return point_of(*found, pair);
    if (const auto inner = inner_vertex(a, pose_a, b, pose_b, pair)) return inner->point;
    return std::nullopt;
}

bool intersects(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const FloatEnvironment environment;
    check_placed(pose_a, "pose of the first mesh");
    check_placed(pose_b, "pose of the second mesh");
    if (is_round(a, b)) return distance_of_round(a, pose_a, b, pose_b, 0).has_value();
    const ShapePair pair(a, pose_a, b, pose_b);
    return meeting_triangles(pair) || inner_vertex(a, pose_a, b, pose_b, pair);
}

std::optional<Distance> distance(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, double max) {
    const FloatEnvironment environment;
    check_placed(pose_a, "pose of the first mesh");
    check_placed(pose_b, "pose of the second mesh");
    check_reach(max, "distance");
    if (is_round(a, b)) return distance_of_round(a, pose_a, b, pose_b, max);
    const ShapePair pair(a, pose_a, b, pose_b);
    if (const auto found = meeting_triangles(pair)) {
        const Vec3 point = point_of(*found, pair);
        return Distance{0, point, point, in_file(a, found->a), in_file(b, found->b)};
    }
    if (const auto inner = inner_vertex(a, pose_a, b, pose_b, pair)) {
        Distance result{0, inner->point, inner->point};
        if (inner->of_a)
            result.triangle_a = in_file(a, a.vertex_triangles()[inner->vertex]);
        else
            result.triangle_b = in_file(b, b.vertex_triangles()[inner->vertex]);
        return result;
    }
    const auto closest = closest_triangles(pair, max);
    if (!closest) return std::nullopt;
    // Of the difference: the points in the world may be rounded by more. Above 0, though it may round to that.
    const Vec3 apart = rotated(pose_b.rotation, closest->point_a - closest->point_b);
    const double metres = std::max(length(apart), std::numeric_limits<double>::min());
    if (metres > max) return std::nullopt;
    return Distance{metres, pair.to_world(closest->point_a), pair.to_world(closest->point_b), in_file(a, closest->a),
                    in_file(b, closest->b)};
}

bool contains(const Shape& shape, const Pose& pose, const Vec3& point) {
    const FloatEnvironment environment;
    check_placed(pose, "pose of the mesh");
    check_place(point, "contains: the point");
    if (const Round* round = shape.round()) return PlacedRound(*round, pose).nearest(point).distance <= 0;
    return shape.has_inside() && is_inside(shape.data(), pose, point);
}

bool contains(const Shape& shape, const Vec3& point) {
    return contains(shape, {}, point);
}

} // namespace raycontact
