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

/// What the report of a mesh should say; the counts of its file and its repairs are taken over. Its coordinates must be
/// those that prepare_mesh() takes. Throws InputError where no triangle has an area.
MeshReport measured_report(const PreparedMesh& mesh);

} // namespace raycontact
