// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include "mesh/adjacency.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What was done about triangles that are of no use.
struct Dropped {
    std::vector<char> triangles; ///< whether each one goes
    std::size_t degenerate = 0, duplicate = 0, back_to_back = 0;
    std::size_t split = 0; ///< triangles that were split in place of a degenerate one
};

/// Whether a vertex occurs twice or all three lie on one line, exactly.
bool is_degenerate(const Triangle& triangle, std::span<const Vec3> vertices);

/// Those that are not degenerate, ascending.
std::vector<std::uint32_t> triangles_with_area(std::span<const Triangle> triangles, std::span<const Vec3> vertices);

/// Finds the degenerate triangles, and those with the vertices and the winding of an earlier one, that can be dropped.
/// Of a surface that is there twice, back to back, and closed, one goes. An edge with an even number of triangles, a
/// closed one, keeps an even number, unless the surface is open there. So a degenerate triangle may have to stay where
/// a corner of one triangle lies on the side of another: if it can, it and that other one become the two halves into
/// which the corner splits it. Equal vertices must have equal indices.
Dropped drop_degenerate(std::vector<Triangle>& triangles, std::span<const Vec3> vertices);

} // namespace raycontact
