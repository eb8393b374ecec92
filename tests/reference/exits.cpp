// SPDX-License-Identifier: Apache-2.0
#include "reference/exits.h"

#include "reference/margins.h"
#include "reference/ray.h"
#include "reference/vector.h"

#include <algorithm>
#include <limits>

namespace raycontact::reference {

namespace {

struct ConeSide {
    double distance = 1; ///< of the unit direction to the cone of triangles; 1 where the apex is closest
    bool outside = false;
};

// Pseudo-normal of the edge from the apex to `other` (Baerentzen and Aanaes 2005).
const Vec3& edge_normal(const Solid& solid, std::uint32_t apex, std::uint32_t other) {
    const auto [low, high] = std::minmax(apex, other);
    const auto found =
        std::lower_bound(solid.edges.begin(), solid.edges.end(), std::array<std::uint32_t, 2>{low, high});
    return solid.edge_normals[static_cast<std::size_t>(found - solid.edges.begin())];
}

// On which side of the infinite wedges of the triangles around `apex` a direction points. The apex itself is closest
// only where the direction is against its pseudo-normal: inside.
ConeSide cone_side(const Solid& solid, std::uint32_t apex, const std::vector<std::uint32_t>& around, const Vec3& d) {
    ConeSide side;
    for (const std::uint32_t t : around) {
        const auto& corners = solid.triangles[t];
        const std::size_t k = corners[0] == apex ? 0 : corners[1] == apex ? 1 : 2;
        const std::uint32_t others[2] = {corners[(k + 1) % 3], corners[(k + 2) % 3]};
        const Vec3 left = solid.vertices[others[0]] - solid.vertices[apex];
        const Vec3 right = solid.vertices[others[1]] - solid.vertices[apex];
        const Vec3& n = solid.face_normals[t];
        const double height = dot(d, n);
        const Vec3 foot = d - height * n;
        if (dot(cross(left, foot), n) > 0 && dot(cross(foot, right), n) > 0 && std::fabs(height) < side.distance)
            side = {std::fabs(height), height > 0};
        for (const std::uint32_t other : others) {
            const Vec3 e = unit(solid.vertices[other] - solid.vertices[apex]);
            const double s = dot(d, e);
            const Vec3 gap = d - s * e;
            if (s > 0 && length(gap) < side.distance)
                side = {length(gap), dot(gap, edge_normal(solid, apex, other)) > 0};
        }
    }
    return side;
}

} // namespace

void add_exits(Solid& solid) {
    std::vector<std::vector<std::uint32_t>> around(solid.vertices.size());
    for (std::uint32_t t = 0; t < solid.triangles.size(); ++t)
        for (const std::uint32_t v : solid.triangles[t]) around[v].push_back(t);

    RayCaster caster(solid);
    double reach = 0;
    for (std::uint32_t v = 0; v < solid.vertices.size(); ++v) {
        const Vec3 inward = -solid.vertex_normals[v];
        if (inward == Vec3{}) { // casts no ray
            solid.exits.push_back(0);
            solid.exit_margins.push_back(solid.cancellation[v]);
            continue;
        }
        const ConeSide side = cone_side(solid, v, around[v], inward);
        double exit = 0;
        double margin = side.distance;
        if (!side.outside) {
            exit = caster.closest_from_inside(solid.vertices[v], inward, v).distance;
            margin = std::min(margin, distance_to_edges(solid, solid.vertices[v], inward, exit, v) / solid.diagonal);
        }
        solid.exits.push_back(exit);
        solid.exit_margins.push_back(margin);
        if (exit < std::numeric_limits<double>::infinity()) reach = std::max(reach, exit);
    }
    solid.reach = reach > 0 ? reach : solid.diagonal;
}

} // namespace raycontact::reference
