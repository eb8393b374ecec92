// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/executor.h"
#include "executor/float_environment.h"
#include "mesh/exact_vector.h"
#include "mesh/predicates.h"
#include "place_on_curve.h"
#include "query/checks.h"
#include "query/inside.h"
#include "query/nearest_triangle.h"
#include "query/placed_round.h"
#include "query/shape_pair.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace raycontact {

namespace {

/// The numbers of the points, so that those in a row are near each other.
std::vector<std::uint32_t> along_curve(std::span<const Vec3> points) {
    const Box box = box_of(points);
    const Vec3 size = box.high - box.low;
    const double scale = 2097151 / std::max({size.x, size.y, size.z, 1e-300});
    std::vector<std::pair<std::uint64_t, std::uint32_t>> places(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) places[i] = {place_on_curve(points[i], box.low, scale), i};
    std::ranges::sort(places);
    std::vector<std::uint32_t> order(points.size());
    std::ranges::transform(places, order.begin(), [](const auto& place) { return place.second; });
    return order;
}

/// Signed distances of points one after the other, each from what is known of the last one.
class SignedDistances {
public:
    SignedDistances(const Shape& shape, const Pose& pose) : shape_(shape), mesh_(shape.data()), pose_(pose) {}

    SignedDistance of(const Vec3& sought) {
        double farthest = any_distance;
        if (face_ != Shape::no_triangle) {
            const NearestFeature last = nearest_feature(mesh_, face_, sought);
            farthest = last.distance() + 2 * last.error();
        }
        const auto nearest = nearest_triangle(mesh_, sought, farthest);
        const NearestFeature& feature = nearest->feature;
        // No surface enters the ball around the last point that touches its nearest one.
        const bool same_side = face_ != Shape::no_triangle && length(sought - point_) < 0.999 * distance_;
        if (!same_side) inside_ = is_inside(sought, *nearest);
        face_ = nearest->face;
        point_ = sought;
        distance_ = feature.distance() - feature.error();

        const double sign = inside_ ? -1 : 1;
        const Vec3 away = rotated(pose_.rotation, feature.away());
        const double metres = length(away);
        // Where rounding decides the direction, the face does.
        const bool apart = metres > 0 && distance_ > 0;
        const Vec3 gradient = apart ? (sign / metres) * away : normal_of(face_);
        return {sign * metres + 0.0, shape_.triangle_index()[face_], transform_point(pose_, feature.point()), gradient};
    }

private:
    std::array<Vec3, 3> corners(std::uint32_t face) const {
        std::array<Vec3, 3> t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = own_point(mesh_.file_vertex(mesh_.mesh.triangles[face][k]));
        return t;
    }

    Vec3 normal_of(std::uint32_t face) const {
        const auto [a, b, c] = corners(face);
        return unit(rotated(pose_.rotation, along_normal(a, b, c)));
    }

    bool is_inside(const Vec3& sought, const NearestTriangle& nearest) const {
        if (!shape_.has_inside()) return false;
        // In front of a face of such a mesh is outside. Exact, since in double the normal of a needle may be turned
        // over.
        if (mesh_.header.outward != 0 && nearest.feature.is_face()) {
            const auto [a, b, c] = corners(nearest.face);
            if (const int side = orient3d(a, b, c, sought)) return side > 0;
        }
        return raycontact::is_inside(mesh_, Pose{}, sought);
    }

    const Shape& shape_;
    const ShapeData& mesh_;
    const Pose& pose_;
    std::uint32_t face_ = Shape::no_triangle; ///< of the last point
    Vec3 point_;
    double distance_ = 0; ///< metres, at most
    bool inside_ = false;
};

} // namespace

std::vector<SignedDistance> signed_distance(const Shape& shape, const Pose& pose, std::span<const Vec3> points,
                                            std::uint32_t threads) {
    const FloatEnvironment environment;
    check_placed(pose, "pose of the mesh");
    for (const Vec3& point : points) check_place(point, "signed_distance: a point");
    Executor executor(threads_for(points.size(), threads));
    if (points.empty()) return {};
    std::vector<SignedDistance> found(points.size());
    if (const Round* round = shape.round()) {
        const PlacedRound placed(*round, pose);
        std::ranges::transform(points, found.begin(), [&](const Vec3& point) {
            const auto [metres, nearest, outward] = placed.nearest(point);
            return SignedDistance{metres, Shape::no_triangle, nearest, outward};
        });
        return found;
    }
    constexpr std::uint32_t in_a_row = 1024;
    const std::vector<std::uint32_t> order = along_curve(points);
    const std::array<double, 9> inverse = inverse_of(pose.rotation);
    executor.each((points.size() + in_a_row - 1) / in_a_row, 1, [&](std::uint32_t row) {
        SignedDistances distances(shape, pose);
        const std::size_t first = std::size_t{row} * in_a_row;
        for (std::size_t i = first; i < std::min(first + in_a_row, points.size()); ++i)
            found[order[i]] = distances.of(in_body_frame(pose, inverse, points[order[i]]));
    });
    return found;
}

} // namespace raycontact
