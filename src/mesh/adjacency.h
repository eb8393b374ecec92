// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include "interruption.h"

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

using Triangle = std::array<std::uint32_t, 3>;

/// One side of an edge: the edge lo < hi as met by edge `corner % 3` (0-1, 1-2, 2-0) of triangle `corner / 3`.
struct HalfEdge {
    std::uint32_t lo, hi, corner;
    bool forward; ///< the triangle runs from lo to hi
    friend auto operator<=>(const HalfEdge&,
                            const HalfEdge&) = default; // NOLINT(modernize-use-nullptr): of clang-tidy 14
    std::uint32_t triangle() const { return corner / 3; }
};

/// Every side of every edge, sorted by (lo, hi, corner), so that the sides of one edge are neighbours in the list.
/// Edges from a vertex to itself (degenerate triangles) are left out. Up to 2^32 / 3 triangles.
std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles);

/// Calls visit(sides of one edge) for every edge.
template <class Visit>
void for_each_edge(std::span<const HalfEdge> edges, Visit&& visit) {
    const InterruptionCheck check;
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
        check();
        while (last < edges.size() && edges[last].lo == edges[first].lo && edges[last].hi == edges[first].hi) ++last;
        visit(edges.subspan(first, last - first));
    }
}

/// How many more triangles run along an edge than against it, from its lower vertex.
inline int balance_of(std::span<const HalfEdge> sides) {
    int balance = 0;
    for (const HalfEdge& side : sides) balance += side.forward ? 1 : -1;
    return balance;
}

/// The edges that an odd number of triangles meets, lower vertex first; and their vertices, rising.
std::vector<std::pair<std::uint32_t, std::uint32_t>> border_edges(std::span<const HalfEdge> edges);
std::vector<std::uint32_t> border_vertices(std::span<const HalfEdge> edges);

/// Triangle across each edge (0-1, 1-2, 2-0): 0xffffffff at a border. Where several meet, solids touch in an edge: then
/// the one across the solid, by the angles around the edge; where windings leave none, the lowest other index.
std::vector<Triangle> triangle_neighbours(std::span<const Triangle> triangles, std::span<const Vec3> vertices);

/// The triangles around each vertex: of(v) is ascending and names each triangle once.
struct VertexTriangles {
    std::vector<std::uint32_t> offsets; ///< vertex count + 1
    std::vector<std::uint32_t> triangles;
    std::span<const std::uint32_t> of(std::uint32_t vertex) const {
        return {triangles.data() + offsets[vertex], triangles.data() + offsets[vertex + 1]};
    }
};

/// Needs every index below vertex_count.
VertexTriangles vertex_triangles(std::span<const Triangle> triangles, std::uint32_t vertex_count);

} // namespace raycontact
