// SPDX-License-Identifier: Apache-2.0
// Which crossings and vertices of a pair belong together (docs/edges.md, "Regions").
#include "edges/pair_edges.h"

#include <algorithm>
#include <utility>

namespace raycontact {

namespace {

constexpr int most_triangles_around = 256;

bool is_sharp(const ShapeData& shape, std::uint32_t triangle, std::size_t side) {
    std::uint32_t owner = triangle; // the lower of the two has the mark
    if (const std::uint32_t across = shape.neighbours[triangle][side]; across != NONE && across < triangle) {
        const std::uint32_t start = shape.mesh.triangles[triangle][side];
        owner = across;
        for (std::size_t k = 0; k < 3; ++k)
            if (shape.neighbours[across][k] == triangle
                && (shape.mesh.triangles[across][k] == start || shape.mesh.triangles[across][(k + 1) % 3] == start))
                side = k;
    }
    return (shape.sharp_edges[owner] >> side & 1u) != 0;
}

} // namespace

void PairEdges::list_curves(const std::array<SourceMesh, 2>& placed, std::size_t side, std::uint32_t first_node) {
    const ShapeData &source = placed[side].source, &target = placed[side].target;
    for (std::size_t i = 0; i < crossings_[side].size(); ++i) {
        const Crossing& c = crossings_[side][i];
        const auto [start, stop] = ends_of(source, c.edge);
        const Vec3 origin = placed[side].vertex(start);
        const Vec3 point = origin + c.at * (placed[side].vertex(stop) - origin);
        for (const std::uint32_t own : {c.edge / 3, source.neighbours[c.edge / 3][c.edge % 3]}) {
            if (own == NONE) continue;
            const std::uint64_t of_source = source.flat_faces[own], of_target = target.flat_faces[c.face];
            curves_.push_back({side == 0 ? of_source << 32 | of_target : of_target << 32 | of_source, 0,
                               first_node + static_cast<std::uint32_t>(i),
                               side == 0 ? point : placed[side].back(point)});
        }
    }
}

// The surfaces cross along closed curves. Those crossings that share a flat face of each body lie on one line; along
// it, the curve runs from the first to the second, from the third to the fourth: a ring's face meets it twice.
void PairEdges::join_curves(const SourceMesh& a_in_b) {
    const auto by_faces = [](const OnCurve& p, const OnCurve& q) {
        return std::pair(p.faces, p.node) < std::pair(q.faces, q.node);
    };
    std::sort(curves_.begin(), curves_.end(), by_faces);
    for (std::size_t begin = 0, end = 0; begin < curves_.size(); begin = end) {
        const std::uint64_t faces = curves_[begin].faces;
        while (end < curves_.size() && curves_[end].faces == faces) ++end;
        const std::span<OnCurve> line = std::span(curves_).subspan(begin, end - begin);
        const Vec3 along = cross(a_in_b.turned(normal_of(a_in_b.source, static_cast<std::uint32_t>(faces >> 32))),
                                 normal_of(a_in_b.target, static_cast<std::uint32_t>(faces)));
        // Edges between small faces are not asked, so one may be missing: then all are one, as on parallel faces.
        const bool in_twos = line.size() % 2 == 0 && length(along) > 1e-6;
        for (OnCurve& crossing : line) crossing.at = dot(crossing.point, along);
        if (in_twos)
            std::sort(line.begin(), line.end(), [](const OnCurve& p, const OnCurve& q) {
                return std::pair(p.at, p.node) < std::pair(q.at, q.node);
            });
        for (std::size_t i = 1; i < line.size(); i += in_twos ? 2 : 1) regions_.join(line[i - 1].node, line[i].node);
    }
    curves_.clear();
}

// What hangs together inside the target: both ends of a piece, pieces that end at the same vertex, and vertices in
// contact with their neighbours.
void PairEdges::join_vertices(const SourceMesh& placed, std::size_t side) {
    const ShapeData& source = placed.source;
    at_vertex_.clear();
    for (const VertexContact& vertex_contact : vertices_[side])
        at_vertex_.emplace_back(vertex_contact.vertex, vertex_contact.region);
    for (const Piece& piece : pieces_[side]) {
        if (piece.ends[0].is_crossing() && piece.ends[1].is_crossing()) regions_.join(piece.region - 1, piece.region);
        for (const End& end : piece.ends)
            if (!end.is_crossing()) at_vertex_.emplace_back(end.vertex, piece.region);
    }
    std::sort(at_vertex_.begin(), at_vertex_.end());
    for (std::size_t i = 1; i < at_vertex_.size(); ++i)
        if (at_vertex_[i].first == at_vertex_[i - 1].first)
            regions_.join(at_vertex_[i].second, at_vertex_[i - 1].second);
    // Along an edge that is crossed the source leaves the target on the way; along a long one in a flat face it may.
    crossed_.clear();
    for (const Crossing& c : crossings_[side]) {
        const auto [start, stop] = ends_of(source, c.edge);
        crossed_.emplace_back(std::minmax(start, stop));
    }
    std::sort(crossed_.begin(), crossed_.end());
    const double near = SourceMesh::small_face * placed.size;
    const auto join_along = [&](std::uint32_t t, std::size_t k, const VertexContact& vertex_contact) {
        const std::uint32_t p = source.mesh.triangles[t][k], q = source.mesh.triangles[t][(k + 1) % 3];
        const std::uint32_t vertex = p == vertex_contact.vertex ? q : p;
        if (!is_sharp(source, t, k) && length(source.point(p) - source.point(q)) > near) return;
        const auto at = std::lower_bound(at_vertex_.begin(), at_vertex_.end(), std::pair{vertex, 0u});
        if (at == at_vertex_.end() || at->first != vertex) return;
        const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(vertex, vertex_contact.vertex);
        if (!std::binary_search(crossed_.begin(), crossed_.end(), edge))
            regions_.join(at->second, vertex_contact.region);
    };
    for (const VertexContact& vertex_contact : vertices_[side]) {
        const std::uint32_t begin = source.vertex_triangle[vertex_contact.vertex];
        // Around the vertex; where a border ends that, the other way round, too.
        std::uint32_t t = begin;
        for (const std::size_t way : {0u, 2u}) {
            for (int count = 0; count < most_triangles_around && t != NONE; ++count) {
                const auto& corners = source.mesh.triangles[t];
                const std::size_t c = corners[0] == vertex_contact.vertex   ? 0
                                      : corners[1] == vertex_contact.vertex ? 1
                                                                            : 2;
                join_along(t, c, vertex_contact);
                join_along(t, (c + 2) % 3, vertex_contact);
                t = source.neighbours[t][(c + way) % 3];
                if (t == begin) break;
            }
            if (t != NONE) break;
            t = begin;
        }
    }
}

} // namespace raycontact
