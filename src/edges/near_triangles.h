// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/source_mesh.h"
#include "shape/tree_walks.h"

#include <vector>

namespace raycontact {

/// Adds every two triangles that come within `margin` metres of each other, and some more: all but those that a box or
/// the plane of one of them shows to be apart, and those without an edge to be asked. first_to_second: the pose of the
/// first in the frame of the second.
void find_near_triangles(const SourceMesh& first_to_second, double margin, std::vector<TrianglePair>& found);

} // namespace raycontact
