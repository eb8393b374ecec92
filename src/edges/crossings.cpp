// SPDX-License-Identifier: Apache-2.0
#include "edges/crossings.h"

#include <algorithm>
#include <tuple>

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

} // namespace

void find_crossings(const PairMeshes& pair, std::size_t side, std::span<const NearEdge> near,
                    std::vector<Crossing>& found) {
    const ShapeData &source = pair.shape(side), &target = pair.shape(1 - side);
    const auto begin = static_cast<std::ptrdiff_t>(found.size());
    for (std::size_t i = 0, end = 0; i < near.size(); i = end) {
        const std::uint32_t edge = near[i].edge;
        while (end < near.size() && near[end].edge == edge) ++end;
        const auto [start, stop] = ends_of(source, edge);
        const Corner p{start, pair.vertex(side, start)}, q{stop, pair.vertex(side, stop)};
        for (; i < end; ++i) {
            const std::uint32_t face = near[i].face;
            std::array<Corner, 3> c;
            for (std::size_t k = 0; k < 3; ++k) {
                c[k].vertex = target.mesh.triangles[face][k];
                c[k].point = pair.vertex(1 - side, c[k].vertex);
            }
            const Vec3 normal = cross(c[1].point - c[0].point, c[2].point - c[0].point);
            const double from = dot(p.point - c[0].point, normal), to = dot(q.point - c[0].point, normal);
            if ((from >= 0) == (to >= 0)) continue;
            std::array<bool, 3> left;
            for (std::size_t k = 0; k < 3; ++k) {
                const Corner &r = c[k], &s = c[(k + 1) % 3];
                left[k] = side == 0 ? passes_left(p, q, r, s) : passes_left(r, s, p, q);
            }
            if (left[0] != left[1] || left[1] != left[2]) continue;
            const double at = from / (from - to);
            found.push_back(
                {static_cast<std::uint32_t>(side), edge, face, at, from < 0, p.point + at * (q.point - p.point)});
        }
    }
    std::sort(found.begin() + begin, found.end(), [](const Crossing& p, const Crossing& q) {
        return std::tie(p.edge, p.at, p.face) < std::tie(q.edge, q.at, q.face);
    });
}

} // namespace raycontact
