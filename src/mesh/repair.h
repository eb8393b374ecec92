// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/triangle_bvh.h"

#include <span>

namespace raycontact {

// Each says in prepared.report.repairs what it changed, and nothing where it changed nothing.

/// A vertex named twice, or all three on one line, exactly. Vertices as snapped() gives them.
bool is_degenerate(const Triangle& triangle, std::span<const Vec3> vertices);
void drop_degenerate(PreparedMesh& prepared, std::span<const Vec3> vertices);

/// Triangles with the vertices and the winding of an earlier one.
void drop_duplicates(PreparedMesh& prepared);

/// Makes the windings of each orientable patch agree, the fewer following the more, then turns closed patches whose
/// winding contradicts their nesting.
void mend_windings(PreparedMesh& prepared, const TriangleBvh& bvh);

} // namespace raycontact
