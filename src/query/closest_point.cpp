// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/nearest_triangle.h"
#include "query/placed_round.h"
#include "query/shape_pair.h"

#include <cmath>

namespace raycontact {

std::optional<ClosestPoint> closest_point(const Shape& shape, const Pose& pose, const Vec3& point, double max) {
    const FloatEnvironment environment;
    check_placed(pose, "pose of the mesh");
    check_place(point, "closest_point: the point");
    check_reach(max, "closest_point");
    if (const Round* round = shape.round()) {
        const PlacedRound::Nearest nearest = PlacedRound(*round, pose).nearest(point);
        const double metres = std::fabs(nearest.distance);
        return metres <= max ? std::optional(ClosestPoint{Shape::no_triangle, nearest.point, metres}) : std::nullopt;
    }
    const Vec3 sought = in_body_frame(pose, inverse_of(pose.rotation), point);
    // What is there exactly is found; `max` decides at the end.
    const auto nearest = nearest_triangle(shape.data(), sought, max * (1 + 1e-12));
    if (!nearest) return std::nullopt;
    const double metres = length(rotated(pose.rotation, nearest->feature.away()));
    if (metres > max) return std::nullopt;
    return ClosestPoint{shape.triangle_index()[nearest->face], transform_point(pose, nearest->feature.point()), metres};
}

} // namespace raycontact
