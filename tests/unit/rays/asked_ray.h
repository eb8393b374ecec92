// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "shape/shape_data.h"

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

inline kernels::prototype::SourceRay prototype_ray(const Vec3& position, const Vec3& direction, double reach) {
    kernels::prototype::SourceRay ray{};
    store(ray.position, position);
    store(ray.direction, direction);
    ray.reach = static_cast<float>(reach);
    return ray;
}

/// What is said of a ray that was held, if it is known, in some lane of a group. margin: of caps, UNBOUNDED: not asked.
inline std::optional<kernels::Hit> ask(const kernels::prototype::SourceRay& moved, const kernels::Held& held,
                                       const ShapeData& target, float margin, std::uint32_t lane,
                                       bool* stepped = nullptr) {
    using namespace kernels::prototype;
    HeldGroup group;
    clear_held(&group);
    for (std::uint32_t i = 0; i <= lane; ++i)
        add_held(&group, 0, &moved, &held, margin, 0, 0, &target.header, target.triangle_blocks.data());
    fetch_triangles(&group, &target.header, target.triangle_blocks.data(), target.face_normals.data());
    ask_tubes_and_caps(&group, &target.header, target.triangle_blocks.data(), target.faces.data(),
                       target.face_normals.data());
    if (stepped != nullptr) *stepped = group.triangle_slot[lane] != held.triangle;
    if (group.is_known[lane] == 0) return std::nullopt;
    return held_hit(&group, lane, &target.header, target.face_normals.data());
}

inline kernels::Hit cast(const kernels::prototype::SourceRay& ray, const ShapeData& target) {
    const kernels::prototype::RayFrame frame = kernels::prototype::frame_ray(ray.position, ray.direction);
    const kernels::prototype::Closest met = kernels::prototype::find_closest(
        0, &frame, ray.reach, &target.header, target.nodes.data(), target.triangle_blocks.data());
    return kernels::prototype::decide(CASTER_BVH, &ray, &met, &target.header, target.nodes.data(),
                                      target.triangle_blocks.data(), target.face_normals.data());
}

inline bool differ(const kernels::Hit& said, const kernels::Hit& truth) {
    return said.triangle != truth.triangle || said.distance != truth.distance || said.facing != truth.facing
           || said.sides != truth.sides;
}

} // namespace raycontact::reference
