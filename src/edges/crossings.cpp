// SPDX-License-Identifier: Apache-2.0
#include "edges/crossings.h"

#include <algorithm>
#include <array>
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

void find_crossings(const SourceMesh& placed, std::span<const TrianglePair> near, bool source_first,
                    std::vector<Crossing>& found) {
    const ShapeData &source = placed.source, &target = placed.target;
    const auto begin = static_cast<std::ptrdiff_t>(found.size());
    std::uint32_t known = NONE;
    unsigned asked = 0; // a bit for each of its edges
    std::array<Vec3, 3> corners;
    for (const TrianglePair& pair : near) {
        const std::uint32_t own = source_first ? pair.first : pair.second,
                            face = source_first ? pair.second : pair.first;
        if (own != known) {
            known = own;
            asked = 0;
            for (std::size_t k = 0; k < 3; ++k)
                if ((source.sharp_edges[own] >> k & 1u) != 0 && source.edge_span(own, k) > placed.span)
                    asked |= 1u << k;
            for (std::size_t k = 0; k < 3 && asked != 0; ++k) corners[k] = placed.vertex(source.mesh.triangles[own][k]);
        }
        if (asked == 0) continue;
        const auto& index = target.mesh.triangles[face];
        const Vec3 v0 = target.point(index[0]), v1 = target.point(index[1]), v2 = target.point(index[2]);
        const Vec3 normal = cross(v1 - v0, v2 - v0);
        std::array<double, 3> above{};
        for (std::size_t k = 0; k < 3; ++k) above[k] = dot(corners[k] - v0, normal);
        for (std::size_t k = 0; k < 3; ++k) {
            const double from = above[k], to = above[(k + 1) % 3];
            if ((asked >> k & 1u) == 0 || (from < 0) == (to < 0)) continue;
            const bool leaves = from < 0;
            const Vec3 origin = corners[k], along = corners[(k + 1) % 3] - origin;
            const Vec3 a = v0 - origin, b = v1 - origin, c = v2 - origin;
            if (!is_within(dot(along, cross(b, c)), index[1], index[2], leaves)
                || !is_within(dot(along, cross(c, a)), index[2], index[0], leaves)
                || !is_within(dot(along, cross(a, b)), index[0], index[1], leaves))
                continue;
            found.push_back({3 * own + static_cast<std::uint32_t>(k), face, from / (from - to), leaves});
        }
    }
    std::sort(found.begin() + begin, found.end(), [](const Crossing& p, const Crossing& q) {
        return std::tie(p.edge, p.at, p.face) < std::tie(q.edge, q.at, q.face);
    });
}

} // namespace raycontact
