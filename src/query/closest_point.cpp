// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/shape_pair.h"
#include "shape/mesh_rays.h"

#include <cmath>

namespace raycontact {

std::optional<ClosestPoint> closest_point(const Shape& shape, const Pose& pose, const Vec3& point, double max) {
    const FloatEnvironment environment;
    check_placed(pose, "pose of the mesh");
    check_place(point, "closest_point: the point");
    check_reach(max, "closest_point");
    const ShapeData& mesh = shape.data();
    const Vec3 sought = rotated(inverse_of(pose.rotation), point - pose.translation) - mesh.centre;
    // As far as rounding puts the point off; where it is far away, that is what decides which boxes are near.
    const double slack = rounding_of(mesh) + 1e-14 * (length(sought) + length(mesh.centre));
    const double float_rounding = float_rounding_of(mesh.reach + length(sought));
    double nearest2 = max * max * (1 + 1e-12); // what is there exactly is found; `max` decides at the end
    std::uint32_t face = NONE;
    Vec3 nearest;
    const auto farthest = [&] {
        const double metres = std::sqrt(nearest2) + slack;
        return metres * metres;
    };
    const auto away = [&](const kernels::Node& node, Lanes<double>& lanes) {
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) lanes[lane] = box_of(node, lane).squared_distance(sought);
    };
    const auto look = [&](const kernels::TriangleBlock& block) {
        const Lanes<float> squares = BlockBoxes(block, slack + float_rounding).squared_distances({sought, sought});
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const std::uint32_t t = block.triangle[lane];
            if (!(squares[lane] <= nearest2) || t == NONE) continue;
            std::array<Vec3, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.file_vertex(mesh.mesh.triangles[t][k]) - mesh.centre;
            const Vec3 at = nearest_point(sought, corners[0], corners[1], corners[2]), off = sought - at;
            const double square = dot(off, off);
            if (square > nearest2
                || (square == nearest2 && face != NONE && shape.triangle_index()[t] >= shape.triangle_index()[face]))
                continue;
            nearest2 = square;
            face = t;
            nearest = at;
        }
    };
    nearest_first<double>(mesh, farthest, away, look);
    if (!mesh.slivers.nodes.empty()) nearest_first<double>(mesh.slivers, farthest, away, look);
    if (face == NONE) return std::nullopt;
    const double metres = length(rotated(pose.rotation, sought - nearest));
    if (metres > max) return std::nullopt;
    return ClosestPoint{shape.triangle_index()[face], transform_point(pose, nearest + mesh.centre), metres};
}

} // namespace raycontact
