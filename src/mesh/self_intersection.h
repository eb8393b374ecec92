// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/triangle_bvh.h"

namespace raycontact {

/// Whether two triangles of the hierarchy meet elsewhere than in the vertices or the edge they share. Exact for
/// vertices as given (see predicates.h). No triangle of the hierarchy may be degenerate. Typically O(n log n).
bool self_intersects(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const TriangleBvh& bvh);

/// The test itself, for two triangles whose vertices are equal exactly where their indices are.
bool triangles_meet(std::span<const Vec3> vertices, const Triangle& a, const Triangle& b);

} // namespace raycontact
