// SPDX-License-Identifier: Apache-2.0
#include "query/nearest_triangle.h"

#include "query/placed_point.h"
#include "query/shape_pair.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <limits>

namespace raycontact {

Vec3 in_body_frame(const Pose& pose, const std::array<double, 9>& inverse, const Vec3& point) {
    return own_point(rotated(inverse, point - pose.translation));
}

NearestFeature nearest_feature(const ShapeData& mesh, std::uint32_t face, const Vec3& sought) {
    NumberedTriangle triangle{{}, mesh.mesh.triangles[face]};
    for (std::size_t k = 0; k < 3; ++k) triangle.corners[k] = own_point(mesh.file_vertex(triangle.vertices[k]));
    return {sought, triangle};
}

namespace {

constexpr float very_far2 = 1e38f; ///< squares may overflow beyond it

/// The squared distance of a point from each of sixteen boxes, m^2, in float32, or very_far2.
template <class Low, class High>
Lanes<float> squared_distances(const std::array<float, 3>& point, Low&& low, High&& high) {
    Lanes<float> squares{};
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const float off = std::max(std::max(low(k, lane) - point[k], point[k] - high(k, lane)), 0.0f);
            squares[lane] += off * off;
        }
    for (float& square : squares) square = std::min(square, very_far2);
    return squares;
}

} // namespace

std::optional<NearestTriangle> nearest_triangle(const ShapeData& mesh, const Vec3& sought, double farthest) {
    static_assert(NODE_LANES == TRIANGLE_LANES);
    const Vec3 centred = sought - mesh.centre;
    // As far as rounding puts the point off, and float32 the boxes.
    const double slack = rounding_of(mesh) + 1e-14 * (length(centred) + length(mesh.centre))
                         + float_rounding_of(mesh.reach + length(centred));
    // More than doubles and needles can put off how far a triangle is.
    const double rough = slack + 2e-6 * mesh.diagonal + 1e-9 * length(centred);
    const std::array point{static_cast<float>(centred.x), static_cast<float>(centred.y), static_cast<float>(centred.z)};
    std::optional<NearestTriangle> nearest;
    const auto farthest2 = [&] {
        const double square = 1.000001 * (farthest + slack) * (farthest + slack);
        return square < double(very_far2) ? static_cast<float>(square) : std::numeric_limits<float>::infinity();
    };
    const auto away = [&](const kernels::Node& node, Lanes<float>& lanes) {
        lanes = squared_distances(
            point, [&](std::size_t k, std::size_t lane) { return node.bounds[k][lane]; },
            [&](std::size_t k, std::size_t lane) { return node.bounds[3 + k][lane]; });
    };
    const auto number_of = [&](std::uint32_t t) { return mesh.mesh.triangle_index[t]; };
    const auto look = [&](const kernels::TriangleBlock& block) {
        const auto end = [&](std::size_t k, std::size_t lane, auto&& of) {
            return of(of(block.corner[k][lane], block.corner[3 + k][lane]), block.corner[6 + k][lane]);
        };
        const Lanes<float> squares = squared_distances(
            point,
            [&](std::size_t k, std::size_t lane) {
                return end(k, lane, [](float a, float b) { return std::min(a, b); });
            },
            [&](std::size_t k, std::size_t lane) {
                return end(k, lane, [](float a, float b) { return std::max(a, b); });
            });
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const std::uint32_t t = block.triangle[lane];
            if (!(squares[lane] <= farthest2()) || t == NONE) continue;
            const auto corner = [&](std::size_t k) {
                return Vec3{block.corner[k][lane], block.corner[k + 1][lane], block.corner[k + 2][lane]};
            };
            if (length(centred - nearest_point(centred, corner(0), corner(3), corner(6))) > farthest + rough) continue;
            const NearestFeature feature = nearest_feature(mesh, t, sought);
            if (feature.distance() - feature.error() > farthest) continue;
            if (nearest) {
                const int order = feature.order(nearest->feature);
                if (order > 0 || (order == 0 && number_of(t) >= number_of(nearest->face))) continue;
            }
            farthest = feature.distance() + feature.error();
            nearest.emplace(NearestTriangle{t, feature});
        }
    };
    nearest_first<float>(mesh, farthest2, away, look);
    if (!mesh.slivers.nodes.empty()) nearest_first<float>(mesh.slivers, farthest2, away, look);
    return nearest;
}

} // namespace raycontact
