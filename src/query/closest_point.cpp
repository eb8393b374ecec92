// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/nearest_feature.h"
#include "query/shape_pair.h"

namespace raycontact {

std::optional<ClosestPoint> closest_point(const Shape& shape, const Pose& pose, const Vec3& point, double max) {
    const FloatEnvironment environment;
    check_placed(pose, "pose of the mesh");
    check_place(point, "closest_point: the point");
    check_reach(max, "closest_point");
    const ShapeData& mesh = shape.data();
    // In the body frame it is a point of doubles; from there on all is decided exactly.
    const Vec3 sought = own_point(rotated(inverse_of(pose.rotation), point - pose.translation));
    const Vec3 centred = sought - mesh.centre;
    // As far as rounding puts the point off; where it is far away, that is what decides which boxes are near.
    const double slack = rounding_of(mesh) + 1e-14 * (length(centred) + length(mesh.centre));
    const double float_rounding = float_rounding_of(mesh.reach + length(centred));
    double farthest = max * (1 + 1e-12); // what is there exactly is found; `max` decides at the end
    std::uint32_t face = NONE;
    std::optional<NearestFeature> nearest;
    const auto farthest2 = [&] { return (farthest + slack) * (farthest + slack); };
    const auto away = [&](const kernels::Node& node, Lanes<double>& lanes) {
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane)
            lanes[lane] = box_of(node, lane).squared_distance(centred);
    };
    const auto is_lower = [&](std::uint32_t t) { return shape.triangle_index()[t] < shape.triangle_index()[face]; };
    const auto look = [&](const kernels::TriangleBlock& block) {
        const Lanes<float> squares = BlockBoxes(block, slack + float_rounding).squared_distances({centred, centred});
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const std::uint32_t t = block.triangle[lane];
            if (!(squares[lane] <= farthest * farthest) || t == NONE) continue;
            NumberedTriangle triangle{{}, mesh.mesh.triangles[t]};
            for (std::size_t k = 0; k < 3; ++k) triangle.corners[k] = own_point(mesh.file_vertex(triangle.vertices[k]));
            const NearestFeature feature(sought, triangle);
            if (feature.distance() - feature.error() > farthest) continue;
            if (nearest) {
                const int order = feature.order(*nearest);
                if (order > 0 || (order == 0 && !is_lower(t))) continue;
            }
            farthest = feature.distance() + feature.error();
            face = t;
            nearest = feature;
        }
    };
    nearest_first<double>(mesh, farthest2, away, look);
    if (!mesh.slivers.nodes.empty()) nearest_first<double>(mesh.slivers, farthest2, away, look);
    if (!nearest) return std::nullopt;
    const double metres = length(rotated(pose.rotation, nearest->away()));
    if (metres > max) return std::nullopt;
    return ClosestPoint{shape.triangle_index()[face], transform_point(pose, nearest->point()), metres};
}

} // namespace raycontact
