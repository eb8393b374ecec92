// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"
#include "unit/kernels/asked_ray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace raycontact::reference {

/// A ray at a triangle's normal-cone ball: from within it, from its rim and from beyond, turned by any angle, through
/// every part of the triangle and of its neighbours, and near enough to the surface, to edges and to the angle at which
/// triangles no longer face alike that some roundings decide.
struct AimedRay {
    kernels::prototype::SourceRay ray;
    std::uint32_t triangle_lane = 0; ///< of the triangle
    double depth = 0;                ///< metres along the ray to the triangle; below 0: from outside
};

/// The triangle's two radii, of the narrow angle and of the wide one, metres.
inline std::array<double, 2> cap_radii(const ShapeData& shape, std::uint32_t triangle_lane) {
    const std::uint32_t cone = kernels::at_place<std::uint32_t>(nullptr, shape.header.normal_cones)[triangle_lane];
    const double unit = double(CONE_UNIT_TOLERANCES) * double(shape.header.tolerance);
    return {double(cone & 0xffffu) * unit, double(cone >> 16) * unit};
}

inline double any_length(double least, double most, Random& random) {
    return least * std::pow(most / least, random.uniform());
}

/// Nothing, where chance fell on a triangle without that normal-cone ball.
inline std::optional<AimedRay> aim_at_cone(const ShapeData& target, double margin, Random& random) {
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(target.faces.size()));
    const std::uint32_t triangle_lane = target.faces[t].triangle_lane;
    if (triangle_lane == NONE) return std::nullopt;
    const double tolerance = double(target.header.tolerance);
    const bool narrow = random.below(2) == 0;
    const double radius = cap_radii(target, triangle_lane)[narrow ? 0 : 1];
    if (!(radius > 0)) return std::nullopt;
    const Vec3 n{target.face_normals[t].x, target.face_normals[t].y, target.face_normals[t].z};
    // The direction: along the normal, or at the widest angle at which anything is said, or any.
    const double open = std::acos(double(narrow ? CONE_NARROW_COSINE : CONE_WIDE_COSINE));
    const double widest = std::acos(double(CONE_LEAST_FACING)) - open;
    const double angles[3] = {widest * random.uniform(), widest * random.uniform(0.97, 1.03), 1.5 * random.uniform()};
    const double angle = angles[random.below(3)];
    Vec3 across = cross(n, random.direction());
    across = (1 / std::max(length(across), 1e-9)) * across;
    const Vec3 d = (1 + 1e-4 * random.uniform(-1, 1)) * (std::cos(angle) * n + std::sin(angle) * across);
    // Through the triangle, or a little beside one of its edges, from there or from farther in or out.
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const std::size_t first = random.below(3);
    const auto corner = corners(target, triangle_lane);
    const Vec3 a = corner[first], b = corner[(first + 1) % 3], c = corner[(first + 2) % 3];
    if (random.below(3) == 0) v = random.uniform(-12, 12) * tolerance / length(c - a);
    if (random.below(6) == 0) u = random.uniform(-2, 3), v = random.uniform(-2, 3);
    const Vec3 through = a + u * (b - a) + v * (c - a);
    double depth = any_length(tolerance, 4 * radius, random);
    if (random.below(4) == 0) depth = random.uniform(0, 12) * tolerance;
    if (random.below(6) == 0) depth = radius * random.uniform(0.99, 1.01) - margin;
    if (random.below(2) == 0) depth = -depth;
    const double reach = random.below(8) == 0   ? double(UNBOUNDED)
                         : random.below(4) == 0 ? std::fabs(depth) + random.uniform(-3, 3) * tolerance
                                                : random.uniform(0.001, 1) * target.diagonal;
    return AimedRay{prototype_ray(through - depth * d, d, std::max(reach, 0.0)), triangle_lane, depth};
}

/// Of a ray of which a triangle is known and no swept clearance: that one, or now and then a neighbour of a neighbour's
/// neighbour.
inline kernels::Held known_triangle(const ShapeData& target, std::uint32_t triangle_lane, Random& random) {
    kernels::Held held = kernels::prototype::nothing_held(0);
    held.triangle = triangle_lane;
    if (random.below(3) > 0) return held;
    std::uint32_t other =
        target.triangle_blocks[triangle_lane / TRIANGLE_LANES].triangle[triangle_lane % TRIANGLE_LANES];
    for (int step = 0; step < 3; ++step) other = target.faces[other].neighbour[random.below(3)];
    held.triangle = target.faces[other].triangle_lane;
    return held;
}

} // namespace raycontact::reference
