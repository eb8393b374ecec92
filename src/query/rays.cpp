// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/float_environment.h"
#include "mesh/exact_vector.h"
#include "mesh/predicates.h"
#include "query/checks.h"
#include "query/placed_round.h"
#include "query/shape_pair.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A ray in the body frame, which predicates take as it is.
struct BodyRay {
    Vec3 origin, direction;
};

struct FaceHit {
    std::uint32_t face = NONE; ///< of the shape
    double distance = infinite;
    double error = 0; ///< of the distance, at most
};

/// A distance as numerator / denominator, which is above 0.
struct ExactDistance {
    Dyadic numerator, denominator;

    /// Where a ray meets the plane of a triangle that is not parallel to it.
    ExactDistance(const BodyRay& ray, const std::array<Vec3, 3>& t) {
        const ExactVec3 normal = area_normal(t[0], t[1], t[2]);
        numerator = dot(normal, ExactVec3(t[0]) - ray.origin);
        denominator = dot(normal, ray.direction);
        if (denominator.sign() > 0) return;
        numerator = Dyadic() - numerator;
        denominator = Dyadic() - denominator;
    }
    /// -1: less than the other one.
    int order(const ExactDistance& other) const {
        return (numerator * other.denominator - other.numerator * denominator).sign();
    }
};

/// Casts a ray at a mesh. Which triangles it meets, and which of them first, is exact; how far away they are is
/// rounded.
class Caster {
public:
    Caster(const Shape& shape, const BodyRay& ray, double most, bool any)
        : shape_(shape), mesh_(shape.data()), ray_(ray), any_(any) {
        best_.distance = most;
        // The tree is asked from where the ray is nearest to the mesh's middle: rounding is least there.
        const Vec3 origin = ray.origin - mesh_.centre;
        shift_ = std::max(0.0, -dot(origin, ray.direction) - 2 * mesh_.reach);
        start_ = origin + shift_ * ray.direction;
        slack_ = rounding_of(mesh_) + 1e-14 * (length(origin) + length(mesh_.centre));
        line_ = FloatLine(mesh_, start_, ray.direction, slack_);
    }

    FaceHit cast() {
        if (length(cross(start_, ray_.direction)) > 1.001 * mesh_.reach + 4 * slack_) return {};
        cast_at(mesh_);
        if (!mesh_.slivers.nodes.empty()) cast_at(mesh_.slivers);
        return best_.face != NONE ? best_ : FaceHit();
    }

private:
    void cast_at(const TriangleTree& tree) {
        std::array<double, 3> inverse;
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = axis(ray_.direction, k);
            inverse[k] = 1 / (std::fabs(d) > 1e-20 ? d : 1e-20);
        }
        const auto farthest = [&] {
            if (any_ && best_.face != NONE) return -infinite;
            return best_.distance * (1 + 1e-12) + best_.error - shift_ + slack_;
        };
        const auto enter = [&](const kernels::Node& node, Lanes<double>& first) {
            Lanes<double> last;
            first.fill(0);
            last.fill(infinite);
            for (std::size_t k = 0; k < 3; ++k) {
                const double low = axis(start_, k) + slack_, high = axis(start_, k) - slack_, by = inverse[k];
                for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
                    const double t0 = (double(node.bounds[k][lane]) - low) * by;
                    const double t1 = (double(node.bounds[3 + k][lane]) - high) * by;
                    first[lane] = std::max(first[lane], std::min(t0, t1));
                    last[lane] = std::min(last[lane], std::max(t0, t1));
                }
            }
            for (std::size_t lane = 0; lane < NODE_LANES; ++lane)
                first[lane] = first[lane] <= last[lane] ? first[lane] : infinite;
        };
        nearest_first<double>(tree, farthest, enter, [&](const kernels::TriangleBlock& block) { cast_at(block); });
    }

    void cast_at(const kernels::TriangleBlock& block) {
        for (std::uint32_t on = triangles_on_line(block, line_, 1); on != 0; on &= on - 1) {
            const std::uint32_t face = block.triangle[static_cast<std::size_t>(std::countr_zero(on))];
            if (any_ && best_.face != NONE) return;
            const FaceHit hit = meet(face);
            if (hit.face != NONE && is_closer(hit)) best_ = hit;
        }
    }

    bool is_closer(const FaceHit& hit) const {
        if (best_.face == NONE) return hit.distance <= best_.distance;
        if (std::fabs(hit.distance - best_.distance) > hit.error + best_.error) return hit.distance < best_.distance;
        const int order = ExactDistance(ray_, corners(hit.face)).order({ray_, corners(best_.face)});
        return order < 0 || (order == 0 && shape_.triangle_index()[hit.face] < shape_.triangle_index()[best_.face]);
    }

    std::array<Vec3, 3> corners(std::uint32_t face) const {
        std::array<Vec3, 3> t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = own_point(mesh_.file_vertex(mesh_.mesh.triangles[face][k]));
        return t;
    }

    // Where the ray meets a triangle, if it does; edges belong to it.
    FaceHit meet(std::uint32_t face) const {
        const std::array<Vec3, 3> t = corners(face);
        int facing = 0; // 1: along the normal
        for (std::size_t k = 0; k < 3; ++k) {
            const int side = line_side(ray_.origin, ray_.direction, t[(k + 1) % 3], t[(k + 2) % 3]);
            if (side * facing < 0) return {};
            if (side != 0) facing = side;
        }
        if (facing == 0) return {}; // edge-on, or without area
        const int behind = orient3d(t[0], t[1], t[2], ray_.origin);
        if (behind == 0) return {face, 0, 0};
        if (behind != facing) return {};
        const Vec3 p = t[1] - t[0], q = t[2] - t[0], off = t[0] - ray_.origin, normal = cross(p, q);
        const double fall = dot(normal, ray_.direction), sizes = length(p) * length(q);
        constexpr double few_roundings = 1e-14, flattest = 0.01;
        if (std::fabs(fall) > flattest * sizes) {
            const double at = std::max(0.0, dot(normal, off) / fall);
            return {face, at, few_roundings * sizes / std::fabs(fall) * (length(off) + at)};
        }
        // A needle, or a ray that runs along the face: double would say anything.
        const ExactDistance exact(ray_, t);
        const double at = ratio(exact.numerator, exact.denominator);
        return {face, at, few_roundings * at};
    }

    const Shape& shape_;
    const ShapeData& mesh_;
    BodyRay ray_;
    bool any_;
    double shift_, slack_;
    Vec3 start_; ///< on the ray, centred frame
    FloatLine line_;
    FaceHit best_;
};

/// Unit, of a ray that is sound.
Vec3 checked_ray(const Pose& pose, const Vec3& origin, const Vec3& direction, double max) {
    check_placed(pose, "pose of the mesh");
    check_place(origin, "raycast: the origin");
    check_reach(max, "raycast");
    return checked_direction(direction);
}

FaceHit cast(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& along, double max, bool any) {
    const std::array<double, 9> back = inverse_of(pose.rotation);
    const BodyRay ray{own_point(rotated(back, origin - pose.translation)), own_point(rotated(back, along))};
    return Caster(shape, ray, max, any).cast();
}

std::optional<RayHit> cast_at_round(const PlacedRound& round, const Vec3& origin, const Vec3& along, double max) {
    const auto metres = round.meet(origin, along);
    if (!metres || *metres > max) return std::nullopt;
    const Vec3 point = origin + *metres * along;
    return RayHit{Shape::no_triangle, *metres, round.nearest(point).outward, point};
}

} // namespace

std::optional<RayHit> raycast(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& direction,
                              double max) {
    const FloatEnvironment environment;
    const Vec3 along = checked_ray(pose, origin, direction, max);
    if (shape.round() != nullptr) return cast_at_round({*shape.round(), pose}, origin, along, max);
    const FaceHit hit = cast(shape, pose, origin, along, max, false);
    if (hit.face == NONE) return std::nullopt;
    const ShapeData& mesh = shape.data();
    const auto [a, b, c] = mesh.mesh.triangles[hit.face];
    const Vec3 normal = along_normal(mesh.file_vertex(a), mesh.file_vertex(b), mesh.file_vertex(c));
    return RayHit{shape.triangle_index()[hit.face], hit.distance, unit(rotated(pose.rotation, normal)),
                  origin + hit.distance * along};
}

bool raycast_any(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& direction, double max) {
    const FloatEnvironment environment;
    const Vec3 along = checked_ray(pose, origin, direction, max);
    if (shape.round() != nullptr) return cast_at_round({*shape.round(), pose}, origin, along, max).has_value();
    return cast(shape, pose, origin, along, max, true).face != NONE;
}

} // namespace raycontact
