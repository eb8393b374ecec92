// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"
#include "mesh/vector.h"
#include "shape/build.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <limits>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double from_here = -1e-300; // at the vertex, too

// Whether the direction leads from the vertex into the mesh. The closest feature of the faces' infinite wedges decides
// by its pseudo-normal (Baerentzen and Aanaes 2005): a face, an edge, or the vertex itself.
bool points_inside(const ShapeData& shape, std::span<const Vec3> normals, std::uint32_t vertex, const Vec3& direction,
                   std::span<const std::uint32_t> around) {
    // Mostly it is on the inner side of every face, so that none of them could decide otherwise.
    constexpr double clearly = -1e-9; // beyond the rounding of a sum of two
    if (std::ranges::all_of(around, [&](std::uint32_t t) { return dot(direction, normals[t]) < clearly; })) return true;
    double best = 0; // cosine to the closest feature; none in front of the direction: the apex, which is inside
    Vec3 decides = shape.vertex_normals[vertex];
    const auto consider = [&](double cosine, const Vec3& normal) {
        if (cosine <= best) return;
        best = cosine;
        decides = normal;
    };
    const auto edge_normal = [&](std::uint32_t triangle, std::size_t edge) {
        const std::uint32_t across = shape.neighbours[triangle][edge];
        return across == Shape::no_triangle ? normals[triangle] : normals[triangle] + normals[across];
    };
    for (const std::uint32_t t : around) {
        const Vec3 n = normals[t];
        if (n == Vec3{}) continue;
        const auto& corners = shape.mesh.triangles[t];
        const std::size_t c = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2, before = (c + 2) % 3;
        Vec3 e1 = shape.corner(t, (c + 1) % 3) - shape.point(vertex),
             e2 = shape.corner(t, before) - shape.point(vertex);
        e1 = (1 / length(e1)) * e1;
        e2 = (1 / length(e2)) * e2;
        const Vec3 flat = direction - dot(direction, n) * n;
        if (dot(cross(e1, flat), n) > 0 && dot(cross(flat, e2), n) > 0) {
            consider(length(flat), n);
        } else {
            consider(dot(direction, e1), edge_normal(t, c));
            consider(dot(direction, e2), edge_normal(t, before));
        }
    }
    return dot(direction, decides) < 0;
}

} // namespace

std::vector<float> measure_exits(const ShapeData& shape, std::span<const Vec3> normals, Executor& executor) {
    const VertexTriangles triangles =
        vertex_triangles(shape.mesh.triangles, static_cast<std::uint32_t>(shape.points.size()));
    std::vector<float> distances(shape.points.size(), 0.0f);
    executor.each(distances.size(), 64, [&](std::uint32_t v) {
        const Vec3 n = shape.vertex_normals[v];
        if (n == Vec3{}) return;
        // The direction that the kernels will use, so that both end at the same face.
        const Vec3 direction{-static_cast<float>(n.x), -static_cast<float>(n.y), -static_cast<float>(n.z)};
        const auto around = triangles.of(v);
        if (points_inside(shape, normals, v, direction, around))
            distances[v] = static_cast<float>(
                closest_hit(shape, {shape.point(v), direction, from_here, never, true, around}).distance);
    });
    return distances;
}

} // namespace raycontact
