// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Outward unit normal of each triangle; zero for one without area.
std::vector<Vec3> face_normals(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

/// Angle-weighted unit normal of each vertex (Thuermer and Wuethrich 1998); zero where the faces around it cancel out.
std::vector<Vec3> angle_weighted_normals(std::span<const Vec3> vertices,
                                         std::span<const std::array<std::uint32_t, 3>> triangles,
                                         std::span<const Vec3> face_normals);

} // namespace raycontact
