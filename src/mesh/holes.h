// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "executor/executor.h"
#include "mesh/adjacency.h"
#include "mesh/mesh_tree.h"

#include <span>
#include <string>
#include <vector>

namespace raycontact {

/// A closed line of border edges that passes no vertex twice, and the triangles over its corners that close the mesh
/// there: with the windings of both, every border edge is met as often one way as the other.
struct Hole {
    std::vector<std::uint32_t> corners; ///< vertices, counter-clockwise seen from outside
    std::vector<Triangle> triangles;    ///< two less than corners
    bool flat = false;                  ///< to a thousandth of its box's diagonal
};

/// Those of a mesh whose windings agree where they can: an edge that more triangles run along one way than the other is
/// a border. edges: the sorted half edges of the triangles. vertices: snapped().
std::vector<Hole> find_holes(std::span<const Triangle> triangles, std::span<const Vec3> vertices,
                             std::span<const HalfEdge> edges);

/// Where a hole is, how large, and how it is spanned, in words.
std::string text_of(const Hole& hole, std::span<const Vec3> vertices);

/// The diagonal of its box, metres.
double size_of(const Hole& hole, std::span<const Vec3> vertices);

/// Whether a mesh is a solid as Holes has it. Its triangles from `first_spanning` on span all its holes. With them the
/// winding number is whole, and told by rays; without them it is that, less the part of the sphere that they cover
/// (van Oosterom and Strackee 1983). tree: over all triangles with an area.
bool is_solid(const PreparedMesh& spanned, std::size_t first_spanning, const MeshTree& tree, Executor& executor);

} // namespace raycontact
