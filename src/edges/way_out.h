// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/edge_pieces.h"

#include <limits>

namespace raycontact {

/// How a piece of an edge leaves the other body (docs/internals/edges.md). Frame of PairMeshes.
struct WayOut {
    double distance = std::numeric_limits<double>::infinity(); ///< metres; infinite: there is none
    double depth = 0;                                          ///< of it along the normal, metres
    Vec3 normal;                                               ///< out of the other body, unit
    std::uint32_t face = NONE;                                 ///< of the other body, where it comes out
    Vec3 point;                                                ///< of the piece
    bool in_arc = true;                                        ///< the edge's own faces leave it free

    bool exists() const { return face != NONE; }
};

/// The shortest way of a piece between two crossings past the ridge in which the planes of their two faces meet: along
/// the cross product of edge and ridge. There is none through a wall.
WayOut way_over_ridge(const PairMeshes& pair, const EdgePiece& piece, std::span<const Crossing> crossings);
/// The way of the vertex at the end of a piece to the plane of a face.
WayOut way_past_face(const PairMeshes& pair, const EdgePiece& piece, std::uint32_t face);
/// The way of that vertex by the plain rule: along its inward normal, before it leaves its own mesh.
WayOut way_of_vertex(const PairMeshes& pair, const EdgePiece& piece);
/// The way from a point of the piece along a direction, as that of a vertex's ray.
WayOut way_along(const PairMeshes& pair, const EdgePiece& piece, const Vec3& point, const Vec3& direction);
/// The inward normal of a piece's edge: the mean of its faces'.
Vec3 inward_of(const PairMeshes& pair, const EdgePiece& piece);
/// The face of the other body at which a ray from a point of a piece comes out of it; NONE if it does not begin inside.
/// A thousandth of the piece's half is left out at its ends.
MeshHit exit_along(const PairMeshes& pair, const EdgePiece& piece, const Vec3& point, const Vec3& way);

} // namespace raycontact
