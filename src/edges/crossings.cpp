// SPDX-License-Identifier: Apache-2.0
#include "edges/crossings.h"

namespace raycontact {

namespace {

struct Corner {
    std::uint32_t vertex;
    Vec3 point;
};

// On which side the line p-q of a passes the line r-s of b. Each pair of edges is computed in one order.
bool passes_left(const Corner& p, const Corner& q, const Corner& r, const Corner& s) {
    const bool turned = (p.vertex > q.vertex) != (r.vertex > s.vertex);
    const auto [from, to] = p.vertex > q.vertex ? std::pair(&q, &p) : std::pair(&p, &q);
    const auto [other_from, other_to] = r.vertex > s.vertex ? std::pair(&s, &r) : std::pair(&r, &s);
    const double volume =
        dot(to->point - from->point, cross(other_from->point - from->point, other_to->point - from->point));
    return (volume >= 0) != turned;
}

// Whether the line of an edge passes a face on one side of its three edges.
bool pierces(std::size_t side, const Corner& p, const Corner& q, const PlacedFace& face) {
    bool first = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const Corner r{face.vertices[k], face.corners[k]}, s{face.vertices[(k + 1) % 3], face.corners[(k + 1) % 3]};
        const bool left = side == 0 ? passes_left(p, q, r, s) : passes_left(r, s, p, q);
        if (k == 0)
            first = left;
        else if (left != first)
            return false;
    }
    return true;
}

double height(const PlacedFace& face, const Vec3& point) {
    return dot(point - face.corners[0], face.normal);
}

Crossing crossing(std::size_t side, std::uint32_t edge, std::uint32_t face, const Vec3& p, const Vec3& q, double from,
                  double to) {
    const double at = from / (from - to);
    return {static_cast<std::uint32_t>(side), edge, face, at, from < 0, p + at * (q - p)};
}

} // namespace

void PlacedFace::set(const PairMeshes& pair, std::size_t side, std::uint32_t number) {
    if (face == number) return;
    face = number;
    vertices = pair.shape(side).mesh.triangles[number];
    for (std::size_t k = 0; k < 3; ++k) corners[k] = pair.vertex(side, vertices[k]);
    normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
}

bool crosses(const PairMeshes& pair, std::size_t side, std::uint32_t edge, const PlacedFace& face, Crossing& found) {
    const auto [start, stop] = ends_of(pair.shape(side), edge);
    const Corner p{start, pair.vertex(side, start)}, q{stop, pair.vertex(side, stop)};
    const double from = height(face, p.point), to = height(face, q.point);
    if ((from >= 0) == (to >= 0) || !pierces(side, p, q, face)) return false;
    found = crossing(side, edge, face.face, p.point, q.point, from, to);
    return true;
}

bool find_other(const PairMeshes& pair, const std::array<PlacedFace, 2>& faces, const Crossing& known,
                Crossing& found) {
    for (std::size_t side = 0; side < 2; ++side) {
        const PlacedFace &own = faces[side], &other = faces[1 - side];
        std::array<double, 3> heights;
        for (std::size_t k = 0; k < 3; ++k) heights[k] = height(other, own.corners[k]);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            if ((heights[k] >= 0) == (heights[next] >= 0)) continue;
            const std::uint32_t edge = edge_of(pair.shape(side), own.face, static_cast<std::uint32_t>(k));
            if (known.side == side && known.edge == edge) continue;
            const Corner p{own.vertices[k], own.corners[k]}, q{own.vertices[next], own.corners[next]};
            if (!pierces(side, p, q, other)) continue;
            // From the edge's first corner: where an edge is crossed is one number.
            const bool turned = ends_of(pair.shape(side), edge)[0] != p.vertex;
            found = turned ? crossing(side, edge, other.face, q.point, p.point, heights[next], heights[k])
                           : crossing(side, edge, other.face, p.point, q.point, heights[k], heights[next]);
            return true;
        }
    }
    return false;
}

} // namespace raycontact
