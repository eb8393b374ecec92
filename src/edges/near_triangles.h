// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/source_mesh.h"

#include <vector>

namespace raycontact {

/// A triangle of the first body and one of the second.
struct TrianglePair {
    std::uint32_t first, second;
};

/// Adds every two triangles whose boxes, in the frame of the second body, come within `margin` metres of each other.
/// A few more may be added. first_to_second: the pose of the first in the frame of the second.
void find_near_triangles(const SourceMesh& first_to_second, double margin, std::vector<TrianglePair>& found);

} // namespace raycontact
