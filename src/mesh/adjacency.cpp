// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"

#include "mesh/vector.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace raycontact {

std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles) {
    std::uint32_t vertex_count = 0;
    for (const Triangle& t : triangles) vertex_count = std::max(vertex_count, std::max({t[0], t[1], t[2]}) + 1);
    const auto for_each_side = [&](auto&& visit) {
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            const Triangle& t = triangles[i];
            for (std::uint32_t e = 0; e < 3; ++e) {
                const std::uint32_t from = t[e], to = t[e == 2 ? 0 : e + 1];
                if (from != to) visit(HalfEdge{std::min(from, to), std::max(from, to), 3 * i + e, from < to});
            }
        }
    };
    // By the lower vertex first, in the order of corners: several times faster than sorting the whole list.
    std::vector<std::uint32_t> next(std::size_t{vertex_count} + 1, 0);
    for_each_side([&](const HalfEdge& side) { ++next[std::size_t{side.lo} + 1]; });
    for (std::size_t v = 0; v < vertex_count; ++v) next[v + 1] += next[v];
    std::vector<HalfEdge> edges(next.back());
    for_each_side([&](const HalfEdge& side) { edges[next[side.lo]++] = side; });
    std::size_t first = 0; // next[v] is now the end of v's
    const InterruptionCheck check;
    for (std::uint32_t v = 0; v < vertex_count; first = next[v++]) {
        check();
        std::sort(
            edges.begin() + static_cast<std::ptrdiff_t>(first), edges.begin() + static_cast<std::ptrdiff_t>(next[v]),
            [](const HalfEdge& a, const HalfEdge& b) { return a.hi != b.hi ? a.hi < b.hi : a.corner < b.corner; });
    }
    return edges;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> border_edges(std::span<const HalfEdge> edges) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> border;
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() % 2 != 0) border.emplace_back(sides[0].lo, sides[0].hi);
    });
    return border;
}

std::vector<std::uint32_t> border_vertices(std::span<const HalfEdge> edges) {
    std::vector<std::uint32_t> ends;
    for (const auto& [lo, hi] : border_edges(edges)) ends.insert(ends.end(), {lo, hi});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
}

namespace {

/// Pairs the sides of an edge that bound one solid. About the edge, as a right hand turns, each solid begins with a
/// triangle that runs against the edge and ends with one that runs along it.
void pair_by_angle(std::span<const HalfEdge> sides, std::span<const Triangle> triangles, std::span<const Vec3> vertices,
                   std::vector<Triangle>& neighbours) {
    const Vec3 &from = vertices[sides[0].lo], along = unit(vertices[sides[0].hi] - from);
    const auto tip = [&](const HalfEdge& side) {
        return vertices[triangles[side.triangle()][(side.corner % 3 + 2) % 3]] - from;
    };
    const Vec3 first = cross(cross(along, tip(sides[0])), along), second = cross(along, first);
    // Angle, whether it runs against the edge, and corner: of two that lie on each other the one that ends a solid
    // first.
    using Side = std::tuple<double, bool, std::uint32_t>;
    std::vector<Side> around;
    for (const HalfEdge& side : sides)
        around.emplace_back(turn_of(dot(tip(side), first), dot(tip(side), second)), !side.forward, side.corner);
    std::ranges::sort(around);
    // Twice around, for a solid that begins last and ends first.
    const std::size_t count = around.size();
    std::vector<char> ended(count, 0);
    std::vector<std::uint32_t> begun; // corners
    for (std::size_t i = 0; i < 2 * count; ++i) {
        const auto& [angle, backward, corner] = around[i % count];
        if (backward && i < count) begun.push_back(corner);
        if (backward || ended[i % count] != 0 || begun.empty()) continue;
        neighbours[corner / 3][corner % 3] = begun.back() / 3;
        neighbours[begun.back() / 3][begun.back() % 3] = corner / 3;
        begun.pop_back();
        ended[i % count] = 1;
    }
}

} // namespace

std::vector<Triangle> triangle_neighbours(std::span<const Triangle> triangles, std::span<const Vec3> vertices) {
    constexpr std::uint32_t none = 0xffffffffu;
    std::vector<Triangle> neighbours(triangles.size(), Triangle{none, none, none});
    for_each_edge(sorted_half_edges(triangles), [&](std::span<const HalfEdge> sides) {
        // Corners ascend, so the lowest triangle comes first. Its neighbour is the second lowest.
        const std::uint32_t lowest = sides[0].triangle();
        const auto other = std::ranges::find_if(sides, [&](const HalfEdge& s) { return s.triangle() != lowest; });
        const std::uint32_t second = other == sides.end() ? none : other->triangle();
        for (const HalfEdge& side : sides)
            neighbours[side.triangle()][side.corner % 3] = side.triangle() == lowest ? second : lowest;
        if (sides.size() > 2) pair_by_angle(sides, triangles, vertices, neighbours);
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
