// SPDX-License-Identifier: Apache-2.0
#include "mesh/descent.h"
#include "shape/build.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

namespace raycontact {

namespace {

using kernels::uint;
constexpr double largest = 65535;         // steps: an eighth of the diagonal
constexpr double least_height = 64;       // of tolerances: float32 may get a narrower triangle's normal wrong
constexpr double beyond_own_corners = 16; // of tolerances
constexpr double fine = 0.75;             // of the triangles have normal-cone balls if testing them pays

/// Directions within an angle, less than a right one, of an axis; cosine <= 0: any direction.
struct Cone {
    Vec3 axis;
    double cosine = 0, sine = 1;

    bool lies_within(const Vec3& normal, double least_cosine) const {
        const double along = dot(axis, normal);
        if (!(cosine > 0) || !(along > 0)) return false;
        return along * cosine - std::sqrt(std::max(0.0, 1 - along * along)) * sine > least_cosine + 1e-9;
    }
};

class NormalCones {
public:
    NormalCones(const ShapeData& shape, std::span<const Vec3> normals)
        : shape_(shape), normals_(normals), cones_(shape.nodes.size()) {
        std::vector<uint> below;
        find_cones(0, below);
    }

    /// Writes the normal-cone balls of a block; returns how many of its triangles have one.
    std::size_t write(std::uint32_t block, Accelerators& to) const {
        std::size_t with_cone = 0;
        const double tolerance = shape_.header.tolerance, unit = double(CONE_UNIT_TOLERANCES) * tolerance;
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const uint t = shape_.triangle_blocks[block].triangle[lane];
            if (t == NONE) continue;
            const Vec3 a = shape_.corner(t, 0), b = shape_.corner(t, 1), c = shape_.corner(t, 2);
            const double longest = std::max({length(b - a), length(c - b), length(a - c)});
            if (length(cross(b - a, c - a)) < least_height * tolerance * longest) continue;
            const Vec3 centre = (1.0 / 3) * (a + b + c);
            const double own = std::max({length(a - centre), length(b - centre), length(c - centre)});
            const auto steps = [&](float cosine, double bound) {
                const double radius = nearest_unlike(centre, normals_[t], double(cosine), bound);
                // One step less: the centre in float32 differs a little.
                return radius > own + beyond_own_corners * tolerance ? std::max(0.0, std::floor(radius / unit) - 1) : 0;
            };
            const double wide = steps(CONE_WIDE_COSINE, largest * unit);
            const double narrow = wide > 0 ? steps(CONE_NARROW_COSINE, (wide + 1) * unit) : 0;
            to.normal_cones[TRIANGLE_LANES * std::size_t{block} + lane] =
                static_cast<uint>(narrow) | static_cast<uint>(wide) << 16;
            with_cone += wide > 0 ? 1 : 0;
        }
        return with_cone;
    }

private:
    /// Distance of the nearest triangle whose normal is farther from `normal` than the angle, at most `bound`.
    double nearest_unlike(const Vec3& from, const Vec3& normal, double least_cosine, double bound) const {
        double bound2 = bound * bound;
        const auto farthest = [&] { return bound2; };
        const auto away = [&](const kernels::Node& node, Lanes<double>& lanes) {
            const auto& cones = cones_[static_cast<std::size_t>(&node - shape_.nodes.data())];
            for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
                const bool alike = cones[lane].lies_within(normal, least_cosine);
                lanes[lane] = alike ? bound2 : box_of(node, lane).squared_distance(from);
            }
        };
        nearest_first<double>(shape_, farthest, away, [&](const kernels::TriangleBlock& block) {
            for (const uint t : block.triangle) {
                if (t == NONE || dot(normals_[t], normal) > least_cosine) continue;
                const Vec3 off =
                    from - nearest_point(from, shape_.corner(t, 0), shape_.corner(t, 1), shape_.corner(t, 2));
                bound2 = std::min(bound2, dot(off, off));
            }
        });
        return std::sqrt(bound2);
    }

    // Appends the triangles below a node to `below`.
    void find_cones(uint n, std::vector<uint>& below) {
        const kernels::Node& node = shape_.nodes[n];
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            if (node.child[lane] == NONE) continue;
            const std::size_t first = below.size();
            if ((node.child[lane] & LEAF) == 0)
                find_cones(node.child[lane], below);
            else
                for (const uint t : shape_.triangle_blocks[node.child[lane] & ~LEAF].triangle)
                    if (t != NONE) below.push_back(t);
            cones_[n][lane] = cone_of(std::span(below).subspan(first));
        }
    }

    Cone cone_of(std::span<const uint> triangles) const {
        Cone cone;
        Vec3 sum{};
        for (const uint t : triangles) sum = sum + normals_[t];
        const double size = length(sum);
        if (!(size > 1e-9)) return cone;
        cone.axis = (1 / size) * sum;
        cone.cosine = 1;
        for (const uint t : triangles) cone.cosine = std::min(cone.cosine, dot(cone.axis, normals_[t]));
        cone.sine = std::sqrt(std::max(0.0, 1 - cone.cosine * cone.cosine));
        return cone;
    }

    const ShapeData& shape_;
    std::span<const Vec3> normals_;
    std::vector<std::array<Cone, NODE_LANES>> cones_;
};

void set_cones_pay(const ShapeData& shape, Accelerators& to, std::size_t with_cone) {
    to.header.cones_pay = double(with_cone) >= fine * double(shape.mesh.triangles.size()) ? 1 : 0;
}

} // namespace

void build_normal_cones(const ShapeData& shape, Accelerators& to, Executor& executor, const std::stop_token& stop) {
    if (to.header.outward == 0) return;
    const std::vector<Vec3> normals = face_normals(shape);
    const NormalCones cones(shape, normals);
    std::atomic<std::size_t> with_cone = 0;
    to.normal_cones.assign(TRIANGLE_LANES * shape.triangle_blocks.size(), 0);
    run_until(executor, stop, shape.triangle_blocks.size(), 16,
              [&](std::uint32_t block) { with_cone += cones.write(block, to); });
    set_cones_pay(shape, to, with_cone);
}

bool restore_normal_cones(const ShapeData& shape, Accelerators& to, std::vector<kernels::uint> cones) {
    const std::size_t lanes = to.header.outward == 0 ? 0 : TRIANGLE_LANES * shape.triangle_blocks.size();
    if (cones.size() != lanes) return false;
    to.normal_cones = std::move(cones);
    const auto is_wide = [](uint cone) { return cone >> 16 != 0; };
    set_cones_pay(shape, to, static_cast<std::size_t>(std::ranges::count_if(to.normal_cones, is_wide)));
    return true;
}

} // namespace raycontact
