// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "executor/executor.h"
#include "mesh/adjacency.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// How far beside a border edge a border vertex may lie that a file means to be on it: twice the last digit of the
/// coordinates, and 1e-4 of the box's diagonal at most. Metres.
double border_tolerance(std::span<const Vec3> vertices);

/// What was done about T-junctions.
struct Stitched {
    std::vector<Triangle> triangles; ///< all; the pieces of one follow each other, each in its place
    std::vector<std::uint32_t> of;   ///< which of those given each one is, or is a piece of
    std::size_t split = 0, at = 0;   ///< triangles that were split, and at how many vertices
    double farthest = 0;             ///< metres from its edge that such a vertex lay
    bool given_up = false;           ///< some were not sought: too many lie near too many edges
};

/// Splits triangles at vertices of borders that lie on their border edges, no farther off than `within` metres. Corner
/// k of a piece, and the edge from there on, is that of the triangle where the piece has it or a part of it. Every
/// vertex must be in use, and equal ones have equal indices. edges: the sorted half edges of the triangles.
Stitched stitch_borders(std::span<const Triangle> triangles, std::span<const Vec3> vertices,
                        std::span<const HalfEdge> edges, double within, Executor& executor);

/// Moves vertices of the borders of a mesh, of each place the lowest, to others of them that are nearer than `within`
/// metres, as weld_mesh() chooses them; nothing where none is.
std::optional<Mesh> join_borders(const Mesh& mesh, const std::vector<std::uint32_t>& vertices, double within);

} // namespace raycontact
