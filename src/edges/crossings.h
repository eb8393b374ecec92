// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/pair_meshes.h"

#include <array>

namespace raycontact {

/// Where an edge of one body pierces a face of the other.
struct Crossing {
    std::uint32_t side; ///< whose edge it is: 0 a, 1 b
    std::uint32_t edge; ///< 3 x its lowest triangle + its first corner
    std::uint32_t face; ///< of the other body
    double at;          ///< along the edge, from 0 at its first corner to 1
    bool leaves;        ///< the edge comes out of the other body here
    Vec3 point;         ///< frame of PairMeshes

    bool is_same(const Crossing& c) const { return side == c.side && edge == c.edge && face == c.face; }
};

/// A triangle of either body, placed.
struct PlacedFace {
    std::uint32_t face = NONE;
    std::array<std::uint32_t, 3> vertices;
    std::array<Vec3, 3> corners;
    Vec3 normal; ///< as long as twice its area

    void set(const PairMeshes& pair, std::size_t side, std::uint32_t face);
};

/// Whether an edge of one body crosses a face of the other. The side on which two edges pass each other has one sign,
/// whichever body's edge asks: so two triangles that meet have two crossings, and the curves in which surfaces cross
/// close.
bool crosses(const PairMeshes& pair, std::size_t side, std::uint32_t edge, const PlacedFace& face, Crossing& found);

/// The other crossing of a triangle of a and one of b that have `known` (which may lie on either); false if there is
/// none.
bool find_other(const PairMeshes& pair, const std::array<PlacedFace, 2>& faces, const Crossing& known, Crossing& found);

} // namespace raycontact
