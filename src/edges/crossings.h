// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/near_edges.h"

#include <span>
#include <vector>

namespace raycontact {

/// Where a sharp edge of the source passes through a face of the target.
struct Crossing {
    std::uint32_t edge; ///< of the source: 3 x its lowest triangle + its first corner
    std::uint32_t face; ///< of the target
    double at;          ///< along the edge, from 0 at its first corner to 1
    bool leaves;        ///< the edge leaves the target here
};

/// Both ends of an edge, as SourceMesh::vertex() places them.
struct EdgeEnds {
    std::uint32_t start, end; ///< vertices
};
inline EdgeEnds ends_of(const ShapeData& shape, std::uint32_t edge) {
    const auto& corners = shape.mesh.triangles[edge / 3];
    return {corners[edge % 3], corners[(edge + 1) % 3]};
}

/// The crossings of the source's sharp edges with the target's faces, sorted by edge, place and face. near: sorted,
/// with every edge that could cross a face.
void find_crossings(const SourceMesh& placed, std::span<const NearEdge> near, std::vector<Crossing>& found);

} // namespace raycontact
