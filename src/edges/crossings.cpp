// SPDX-License-Identifier: Apache-2.0
#include "edges/crossings.h"

#include <algorithm>
#include <tuple>

namespace raycontact {

namespace {

// On which side of the directed edge p-q of the target the line passes. Exactly 0 is left to one of the two triangles
// at the edge: so a surface crossed from one side is crossed once, and a fold touched by the line twice or not at all.
bool is_within(double volume, std::uint32_t p, std::uint32_t q, bool leaves) {
    if (volume != 0) return (volume > 0) == leaves;
    return (p < q) == leaves;
}

} // namespace

void find_crossings(const SourceMesh& placed, std::span<const NearEdge> near, std::vector<Crossing>& found) {
    const ShapeData &source = placed.source, &target = placed.target;
    const auto begin = static_cast<std::ptrdiff_t>(found.size());
    for (std::size_t i = 0, end = 0; i < near.size(); i = end) {
        const std::uint32_t edge = near[i].edge;
        while (end < near.size() && near[end].edge == edge) ++end;
        if (!(source.edge_span(edge / 3, edge % 3) > placed.span)) continue;
        const auto [start, stop] = ends_of(source, edge);
        const Vec3 origin = placed.vertex(start), last = placed.vertex(stop), along = last - origin;
        for (; i < end; ++i) {
            const std::uint32_t face = near[i].face;
            const auto& index = target.mesh.triangles[face];
            const Vec3 v0 = target.point(index[0]), v1 = target.point(index[1]), v2 = target.point(index[2]);
            const Vec3 a = v0 - origin, b = v1 - origin, c = v2 - origin;
            const Vec3 normal = cross(v1 - v0, v2 - v0);
            const double from = dot(origin - v0, normal), to = dot(last - v0, normal);
            if ((from < 0) == (to < 0)) continue;
            const bool leaves = from < 0;
            if (!is_within(dot(along, cross(b, c)), index[1], index[2], leaves)
                || !is_within(dot(along, cross(c, a)), index[2], index[0], leaves)
                || !is_within(dot(along, cross(a, b)), index[0], index[1], leaves))
                continue;
            found.push_back({edge, face, from / (from - to), leaves});
        }
    }
    std::sort(found.begin() + begin, found.end(), [](const Crossing& p, const Crossing& q) {
        return std::tie(p.edge, p.at, p.face) < std::tie(q.edge, q.at, q.face);
    });
}

} // namespace raycontact
