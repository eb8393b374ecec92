// SPDX-License-Identifier: Apache-2.0
#include "reference/solid_edges.h"

#include "reference/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace raycontact::reference {

namespace {

bool in_one_direction(const Vec3& n, const Vec3& m) {
    return dot(n, m) > 0 && length(cross(n, m)) <= 4e-5;
}

} // namespace

std::vector<Edge> edges_of(const Solid& solid) {
    std::vector<std::uint32_t> order(solid.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](auto s, auto t) { return solid.triangle_index[s] < solid.triangle_index[t]; });
    std::map<std::array<std::uint32_t, 2>, std::size_t> found;
    std::vector<Edge> edges;
    for (const std::uint32_t t : order)
        for (std::uint32_t c = 0; c < 3; ++c) {
            const std::uint32_t from = solid.triangles[t][c], to = solid.triangles[t][(c + 1) % 3];
            const std::array<std::uint32_t, 2> ends{std::min(from, to), std::max(from, to)};
            const auto [at, fresh] = found.try_emplace(ends, edges.size());
            if (fresh) {
                edges.push_back({3 * solid.triangle_index[t] + c, from, to, {t, none}, true, false});
                continue;
            }
            Edge& edge = edges[at->second];
            edge.faces[1] = t;
            edge.sharp = !in_one_direction(solid.face_normals[edge.faces[0]], solid.face_normals[t]);
            const Vec3 opposite = solid.vertices[solid.triangles[t][(c + 2) % 3]];
            edge.concave = dot(solid.face_normals[edge.faces[0]], opposite - solid.vertices[from]) > 0;
        }
    for (Edge& edge : edges) {
        const double half = length(solid.vertices[edge.to] - solid.vertices[edge.from]) / 2;
        edge.hides = half;
        if (edge.faces[1] == none) continue;
        const Vec3 &n = solid.face_normals[edge.faces[0]], &m = solid.face_normals[edge.faces[1]];
        const double turned = std::atan2(length(cross(n, m)), dot(n, m));
        edge.hides = edge.concave ? 0 : half * std::min(1.0, std::tan(turned / 2));
    }
    return edges;
}

} // namespace raycontact::reference
