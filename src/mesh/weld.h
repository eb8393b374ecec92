// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include "mesh/adjacency.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// For each point the lowest index of a point at exactly its place; -0 is 0. Linear.
std::vector<std::uint32_t> lowest_at_same_place(std::span<const Vec3> points);

/// For each triangle the lowest index of a triangle with its three vertices and its winding. Linear.
std::vector<std::uint32_t> lowest_same_triangle(std::span<const Triangle> triangles);

} // namespace raycontact
