// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"

#include <algorithm>
#include <utility>

namespace raycontact {

std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles) {
    // A counting sort by the lower vertex, then short sorts: several times faster than sorting the whole list.
    std::size_t vertex_count = 0;
    for (const Triangle& t : triangles) {
        for (const std::uint32_t v : t) vertex_count = std::max<std::size_t>(vertex_count, std::size_t{v} + 1);
    }
    std::vector<std::uint32_t> offsets(vertex_count + 1, 0);
    const auto for_each_edge = [&](auto&& visit) {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            for (std::size_t e = 0; e < 3; ++e) {
                const std::uint32_t from = triangles[i][e], to = triangles[i][(e + 1) % 3];
                if (from != to) visit(from, to, static_cast<std::uint32_t>(3 * i + e));
            }
        }
    };
    for_each_edge([&](std::uint32_t from, std::uint32_t to, std::uint32_t) { ++offsets[std::min(from, to) + 1]; });
    for (std::size_t v = 0; v < vertex_count; ++v) offsets[v + 1] += offsets[v];

    std::vector<HalfEdge> edges(offsets.back());
    std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
    for_each_edge([&](std::uint32_t from, std::uint32_t to, std::uint32_t corner) {
        edges[next[std::min(from, to)]++] = {std::min(from, to), std::max(from, to), corner, from < to};
    });
    for (std::size_t v = 0; v < vertex_count; ++v) {
        std::sort(edges.begin() + offsets[v], edges.begin() + offsets[v + 1], [](const HalfEdge& a, const HalfEdge& b) {
            return std::pair(a.hi, a.corner) < std::pair(b.hi, b.corner);
        });
    }
    return edges;
}

std::vector<Triangle> triangle_neighbours(std::span<const Triangle> triangles) {
    constexpr std::uint32_t none = 0xffffffffu;
    std::vector<Triangle> neighbours(triangles.size(), Triangle{none, none, none});
    const std::vector<HalfEdge> edges = sorted_half_edges(triangles);
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
        while (last < edges.size() && edges[last].lo == edges[first].lo && edges[last].hi == edges[first].hi) ++last;
        // Corners ascend, so the lowest triangle comes first; it alone looks further, for the lowest after itself.
        const std::uint32_t lowest = edges[first].triangle();
        std::uint32_t second = none;
        for (std::size_t i = first; i < last && second == none; ++i) {
            if (edges[i].triangle() != lowest) second = edges[i].triangle();
        }
        for (std::size_t i = first; i < last; ++i) {
            const std::uint32_t corner = edges[i].corner;
            neighbours[corner / 3][corner % 3] = corner / 3 == lowest ? second : lowest;
        }
    }
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
