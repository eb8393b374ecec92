// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Fills the caps of triangle_blocks (kernels/cap.h), from below; 0, where the mesh is not closed and outward, of
/// needles and of triangles larger than their cap. Wants the tree and the header's flags and tolerance.
void build_caps(ShapeData& shape, std::span<const Vec3> face_normals);

} // namespace raycontact
