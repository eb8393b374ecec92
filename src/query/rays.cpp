// SPDX-License-Identifier: Apache-2.0
#include <raycontact/query.h>

#include "executor/float_environment.h"
#include "mesh/predicates.h"
#include "query/checks.h"
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
};

/// Casts a ray at a mesh. Which triangles it meets is exact; how far away they are is rounded.
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
            return best_.distance * (1 + 1e-12) - shift_ + slack_;
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
            const double at = meet(face);
            if (at > best_.distance || (at == best_.distance && !is_lower(face))) continue;
            if (at == infinite) continue;
            best_ = {face, at};
        }
    }

    bool is_lower(std::uint32_t face) const {
        return best_.face == NONE || shape_.triangle_index()[face] < shape_.triangle_index()[best_.face];
    }

    // How far along the ray it meets a triangle; edges belong to it. Infinite: it does not.
    double meet(std::uint32_t face) const {
        std::array<Vec3, 3> t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = own_point(mesh_.file_vertex(mesh_.mesh.triangles[face][k]));
        int facing = 0; // 1: along the normal
        for (std::size_t k = 0; k < 3; ++k) {
            const int side = line_side(ray_.origin, ray_.direction, t[(k + 1) % 3], t[(k + 2) % 3]);
            if (side * facing < 0) return infinite;
            if (side != 0) facing = side;
        }
        if (facing == 0) return infinite; // edge-on, or without area
        const int behind = orient3d(t[0], t[1], t[2], ray_.origin);
        if (behind == 0) return 0;
        if (behind != facing) return infinite;
        const Vec3 &o = ray_.origin, &d = ray_.direction;
        const std::array along{dot(t[0] - o, d), dot(t[1] - o, d), dot(t[2] - o, d)};
        const auto [nearest, farthest] = std::minmax({along[0], along[1], along[2]});
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        const double at = dot(normal, t[0] - o) / dot(normal, d);
        // A needle's normal may be anything: no triangle is farther or nearer than its corners.
        return std::max(0.0, at >= nearest && at <= farthest ? at : std::clamp(at, nearest, farthest));
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

struct PlacedRay {
    Vec3 direction; ///< world, unit
    FaceHit hit;
};

PlacedRay cast(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& direction, double max, bool any) {
    check_placed(pose, "pose of the mesh");
    check_place(origin, "raycast: the origin");
    check_reach(max, "raycast");
    const Vec3 along = checked_direction(direction);
    const std::array<double, 9> back = inverse_of(pose.rotation);
    const BodyRay ray{own_point(rotated(back, origin - pose.translation)), own_point(rotated(back, along))};
    return {along, Caster(shape, ray, max, any).cast()};
}

} // namespace

std::optional<RayHit> raycast(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& direction,
                              double max) {
    const FloatEnvironment environment;
    const PlacedRay ray = cast(shape, pose, origin, direction, max, false);
    if (ray.hit.face == NONE) return std::nullopt;
    const ShapeData& mesh = shape.data();
    const auto [a, b, c] = mesh.mesh.triangles[ray.hit.face];
    const Vec3& corner = mesh.file_vertex(a);
    const Vec3 normal = cross(mesh.file_vertex(b) - corner, mesh.file_vertex(c) - corner);
    return RayHit{shape.triangle_index()[ray.hit.face], ray.hit.distance, unit(rotated(pose.rotation, normal)),
                  origin + ray.hit.distance * ray.direction};
}

bool raycast_any(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& direction, double max) {
    const FloatEnvironment environment;
    return cast(shape, pose, origin, direction, max, true).hit.face != NONE;
}

} // namespace raycontact
