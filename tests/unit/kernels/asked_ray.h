// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "shape/shape_data.h"

#include <array>
#include <cstdint>
#include <optional>

namespace raycontact::reference {

inline Vec3 vec(const float (&a)[3]) {
    return {a[0], a[1], a[2]};
}

inline void store(float (&to)[3], const Vec3& from) {
    to[0] = static_cast<float>(from.x);
    to[1] = static_cast<float>(from.y);
    to[2] = static_cast<float>(from.z);
}

/// The corners of the triangle at a triangle_lane, as the kernels see them.
inline std::array<Vec3, 3> corners(const ShapeData& shape, std::uint32_t triangle_lane) {
    const kernels::TriangleBlock& block = shape.triangle_blocks[triangle_lane / TRIANGLE_LANES];
    const std::uint32_t lane = triangle_lane % TRIANGLE_LANES;
    std::array<Vec3, 3> all;
    for (std::size_t k = 0; k < 3; ++k)
        all[k] = {block.corner[3 * k][lane], block.corner[3 * k + 1][lane], block.corner[3 * k + 2][lane]};
    return all;
}

inline kernels::prototype::SourceRay prototype_ray(const Vec3& position, const Vec3& direction, double reach) {
    kernels::prototype::SourceRay ray{};
    store(ray.position, position);
    store(ray.direction, direction);
    ray.reach = static_cast<float>(reach);
    return ray;
}

/// Of a pair of which nothing was held. radius: of swept clearances to be sought.
inline kernels::HeldRange held_range(double margin, double radius, bool tests_cones) {
    return {0, 0, 0, static_cast<float>(margin), static_cast<float>(radius), tests_cones ? 1u : 0u};
}

/// What is said of a held ray, and the place of the triangle that says it.
struct Said {
    kernels::Hit hit;
    std::uint32_t triangle_lane = 0;
};

/// What kernels read of a shape alone.
inline kernels::prototype::RayArrays arrays_of(const ShapeData& shape) {
    kernels::prototype::RayArrays arrays{};
    arrays.shapes = &shape.header;
    return arrays;
}

/// Of the ray in that lane of a group that has been asked; nothing, where the ray is not known.
inline std::optional<Said> said_of(const kernels::prototype::RayArrays& arrays,
                                   const kernels::prototype::HeldGroup& group, std::uint32_t lane) {
    if (group.is_known[lane] == 0) return std::nullopt;
    return Said{kernels::prototype::held_hit(&arrays, &group, lane), group.triangle_lane[lane]};
}

/// Asked alone: all lanes up to this one hold the same ray.
inline std::optional<Said> ask(const kernels::prototype::SourceRay& moved, const kernels::Held& held,
                               const ShapeData& target, const kernels::HeldRange& held_range, std::uint32_t lane) {
    using namespace kernels::prototype;
    const RayArrays arrays = arrays_of(target);
    HeldGroup group{};
    for (std::uint32_t i = 0; i <= lane; ++i)
        add_held(&arrays, &group, 0, &moved, &held, &held_range, 0, &target.header);
    fetch_triangles(&arrays, &group);
    test_clearances_and_cones(&arrays, &group);
    return said_of(arrays, group, lane);
}

inline kernels::prototype::Closest closest(const kernels::prototype::SourceRay& ray, const ShapeData& target) {
    const kernels::prototype::RayFrame frame = kernels::prototype::frame_ray(ray.position, ray.direction, false);
    return kernels::prototype::traverse_bvh(frame, ray.reach, &target.header, nullptr);
}

inline kernels::Hit cast(const kernels::prototype::SourceRay& ray, const ShapeData& target) {
    const kernels::prototype::Closest met = closest(ray, target);
    const kernels::prototype::RayArrays arrays = arrays_of(target);
    return kernels::prototype::decide(&arrays, CASTER_BVH, &ray, &met, &target.header);
}

/// What is held of a ray that was cast, if a swept clearance was wide enough.
inline kernels::Held held_after_cast(const kernels::prototype::SourceRay& ray, const ShapeData& target,
                                     const kernels::HeldRange& held_range) {
    const kernels::prototype::Closest met = closest(ray, target);
    const kernels::prototype::RayArrays arrays = arrays_of(target);
    return kernels::prototype::seek_clearance(&arrays, &ray, &met, &held_range, &target.header);
}

inline bool differ(const kernels::Hit& said, const kernels::Hit& truth) {
    return said.triangle != truth.triangle || said.distance != truth.distance || said.facing != truth.facing
           || said.sides != truth.sides;
}

} // namespace raycontact::reference
