// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"

#include <algorithm>

namespace raycontact {

std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles) {
    std::uint32_t vertex_count = 0;
    for (const Triangle& t : triangles) vertex_count = std::max(vertex_count, std::max({t[0], t[1], t[2]}) + 1);
    // Vertex by vertex: several times faster than sorting the whole list.
    const VertexTriangles around = vertex_triangles(triangles, vertex_count);
    std::vector<HalfEdge> edges;
    edges.reserve(3 * triangles.size());
    for (std::uint32_t lo = 0; lo < vertex_count; ++lo) {
        const auto first = static_cast<std::ptrdiff_t>(edges.size());
        for (const std::uint32_t t : around.of(lo)) {
            for (std::uint32_t e = 0; e < 3; ++e) {
                const std::uint32_t from = triangles[t][e], to = triangles[t][(e + 1) % 3];
                if (from == lo && to > lo) edges.push_back({lo, to, 3 * t + e, true});
                if (to == lo && from > lo) edges.push_back({lo, from, 3 * t + e, false});
            }
        }
        std::sort(edges.begin() + first, edges.end());
    }
    return edges;
}

std::vector<Triangle> triangle_neighbours(std::span<const Triangle> triangles) {
    constexpr std::uint32_t none = 0xffffffffu;
    std::vector<Triangle> neighbours(triangles.size(), Triangle{none, none, none});
    for_each_edge(sorted_half_edges(triangles), [&](std::span<const HalfEdge> sides) {
        // Corners ascend, so the lowest triangle comes first. Its neighbour is the second lowest.
        const std::uint32_t lowest = sides[0].triangle();
        const auto other = std::ranges::find_if(sides, [&](const HalfEdge& s) { return s.triangle() != lowest; });
        const std::uint32_t second = other == sides.end() ? none : other->triangle();
        for (const HalfEdge& side : sides)
            neighbours[side.triangle()][side.corner % 3] = side.triangle() == lowest ? second : lowest;
    });
    return neighbours;
}

VertexTriangles vertex_triangles(std::span<const Triangle> triangles, std::uint32_t vertex_count) {
    VertexTriangles lists;
    lists.offsets.assign(std::size_t{vertex_count} + 1, 0);
    const auto for_each_corner = [&](auto&& visit) {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const auto [a, b, c] = triangles[i];
            visit(a, i);
            if (b != a) visit(b, i);
            if (c != a && c != b) visit(c, i);
        }
    };
    for_each_corner([&](std::uint32_t v, std::size_t) { ++lists.offsets[std::size_t{v} + 1]; });
    for (std::size_t v = 0; v < vertex_count; ++v) lists.offsets[v + 1] += lists.offsets[v];
    lists.triangles.resize(lists.offsets.back());
    std::vector<std::uint32_t> next(lists.offsets.begin(), lists.offsets.end() - 1);
    for_each_corner(
        [&](std::uint32_t v, std::size_t i) { lists.triangles[next[v]++] = static_cast<std::uint32_t>(i); });
    return lists;
}

} // namespace raycontact
