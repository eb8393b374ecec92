// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// How far the ray from each vertex along its inward normal travels inside its own mesh before it leaves, metres: the
/// closest face met from inside, the triangles around the vertex left out. +inf where there is none, 0 where the ray
/// points out of the mesh at once. Needs points, vertex_normals, nodes and triangle_blocks. A rigid body's never
/// change, so the paper's second test ("before leaving the source object", section 2.1) costs nothing at run time.
std::vector<float> measure_exits(const ShapeData& shape, std::span<const Vec3> face_normals);

} // namespace raycontact
