// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Fills triangle_blocks and nodes: a sixteen-wide tree over blocks of sixteen triangles, split by the surface area
/// heuristic at multiples of a block so that blocks are full. Triangles without area are left out. At most
/// NODE_LEVELS deep. `grow` (metres) is added around every box for the rounding of ray tests. Deterministic.
void build_bvh(ShapeData& shape, std::span<const Vec3> face_normals, double grow);

} // namespace raycontact
