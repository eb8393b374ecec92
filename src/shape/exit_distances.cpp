// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"
#include "mesh/vector.h"
#include "shape/build.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// Whether the direction leads from the vertex into the mesh. The closest feature of the faces' infinite wedges decides
// by its pseudo-normal (Baerentzen and Aanaes 2005): a face, an edge, or the vertex itself.
bool points_inside(const ShapeData& shape, std::span<const Vec3> normals, std::uint32_t vertex, const Vec3& direction,
                   std::span<const std::uint32_t> around) {
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

// Distance at which a ray enters the box of a node's child.
double enters(const kernels::Node& node, int lane, const Vec3& origin, const Vec3& direction) {
    double enter = 0, leave = never;
    for (std::size_t k = 0; k < 3; ++k) {
        const double low = node.bounds[k][lane], high = node.bounds[3 + k][lane];
        const double o = axis(origin, k), d = axis(direction, k);
        if (d == 0) {
            if (o < low || o > high) return never;
            continue;
        }
        const double t0 = (low - o) / d, t1 = (high - o) / d;
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return enter <= leave ? enter : never;
}

// Distance at which a ray meets a triangle from inside. Edges belong to the triangle.
double distance_from_inside(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 p = a - origin, q = b - origin, r = c - origin;
    const double u = dot(cross(q, r), direction), v = dot(cross(r, p), direction), w = dot(cross(p, q), direction);
    if (u < 0 || v < 0 || w < 0) return never; // from outside, or beside it
    const double volume = u + v + w;
    if (volume == 0) return never;
    const double t = (u * dot(p, direction) + v * dot(q, direction) + w * dot(r, direction)) / volume;
    return t >= 0 ? t : never;
}

double leaves(const ShapeData& shape, const Vec3& origin, const Vec3& direction,
              std::span<const std::uint32_t> around) {
    double nearest = never;
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const kernels::Node& node = shape.nodes[open.back()];
        open.pop_back();
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child == NONE) continue;
            const double at = enters(node, lane, origin, direction);
            if (at > nearest || at == never) continue;
            if ((child & LEAF) == 0) {
                open.push_back(child);
                continue;
            }
            for (const std::uint32_t t : shape.triangle_blocks[child & ~LEAF].triangle)
                if (t != NONE && !std::binary_search(around.begin(), around.end(), t))
                    nearest = std::min(nearest, distance_from_inside(origin, direction, shape.corner(t, 0),
                                                                     shape.corner(t, 1), shape.corner(t, 2)));
        }
    }
    return nearest;
}

} // namespace

std::vector<float> measure_exits(const ShapeData& shape, std::span<const Vec3> normals) {
    const VertexTriangles triangles =
        vertex_triangles(shape.mesh.triangles, static_cast<std::uint32_t>(shape.points.size()));
    std::vector<float> distances(shape.points.size(), 0.0f);
    for (std::uint32_t v = 0; v < distances.size(); ++v) {
        const Vec3 n = shape.vertex_normals[v];
        if (n == Vec3{}) continue;
        // The direction that the kernels will use, so that both end at the same face.
        const Vec3 direction{-static_cast<float>(n.x), -static_cast<float>(n.y), -static_cast<float>(n.z)};
        const auto around = triangles.of(v);
        if (points_inside(shape, normals, v, direction, around))
            distances[v] = static_cast<float>(leaves(shape, shape.point(v), direction, around));
    }
    return distances;
}

} // namespace raycontact
