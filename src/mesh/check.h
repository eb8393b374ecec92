// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/patches.h"
#include "mesh/triangle_bvh.h"

namespace raycontact {

/// Throws InputError, which calls the mesh `name`, if it is empty, too large, not finite or out of range.
void check_mesh(const Mesh& mesh, const std::string& name);

/// Fills the report, except its repairs and the counts of the file. The hierarchy is over snapped vertices.
void fill_report(PreparedMesh& prepared, const Patches& patches, std::span<const HalfEdge> edges,
                 std::span<const Vec3> snapped_vertices, const TriangleBvh& bvh);

} // namespace raycontact
