// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/near_edges.h"
#include "edges/pair_meshes.h"

#include <span>
#include <vector>

namespace raycontact {

/// Where an edge of one body pierces a face of the other.
struct Crossing {
    std::uint32_t side; ///< whose edge it is: 0 a, 1 b
    std::uint32_t edge; ///< 3 x its lowest triangle + its first corner
    std::uint32_t face; ///< of the other body
    double at;          ///< along the edge, from 0 at its first corner to 1
    bool leaves;        ///< the edge comes out of the other body here
    Vec3 point;         ///< frame of PairMeshes
};

/// The crossings of one body's edges with the other's faces, added in the order of edge, place and face. near: sorted,
/// with every edge that could cross a face. The side on which two edges pass each other has one sign, whichever body's
/// edge asks: so two triangles that meet have two crossings, and the curves in which surfaces cross close.
void find_crossings(const PairMeshes& pair, std::size_t side, std::span<const NearEdge> near,
                    std::vector<Crossing>& found);

} // namespace raycontact
