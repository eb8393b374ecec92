// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"
#include "mesh/vector.h"
#include "shape/build.h"

#include <algorithm>
#include <array>
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

// A ray of float32 values against the boxes of a node in float32: they are grown by more than it rounds
// (docs/design.md).
struct BoxRay {
    std::array<float, 3> origin, inverse;

    BoxRay(const Vec3& o, const Vec3& d) {
        for (std::size_t k = 0; k < 3; ++k) {
            constexpr double steep = 1e30;
            origin[k] = static_cast<float>(axis(o, k));
            const double inverted = axis(d, k) != 0 ? 1 / axis(d, k) : steep;
            inverse[k] = static_cast<float>(std::clamp(inverted, -steep, steep));
        }
    }

    // Where it enters each child; `never` where it does not.
    void enter(const kernels::Node& node, float (&enters)[NODE_LANES]) const {
        const float *low[3], *high[3]; // the planes that it meets first and last
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = node.bounds[inverse[k] < 0 ? 3 + k : k];
            high[k] = node.bounds[inverse[k] < 0 ? k : 3 + k];
        }
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            const float nx = (low[0][lane] - origin[0]) * inverse[0], fx = (high[0][lane] - origin[0]) * inverse[0];
            const float ny = (low[1][lane] - origin[1]) * inverse[1], fy = (high[1][lane] - origin[1]) * inverse[1];
            const float nz = (low[2][lane] - origin[2]) * inverse[2], fz = (high[2][lane] - origin[2]) * inverse[2];
            const float near = nx > ny ? nx : ny, far = fx < fy ? fx : fy;
            const float at = near > nz ? near : nz, to = far < fz ? far : fz;
            const float from = at > 0 ? at : 0;
            enters[lane] = from <= to ? from : std::numeric_limits<float>::infinity();
        }
    }
};

// Distances at which a ray meets a block's triangles from inside. Edges belong to a triangle.
void meet_from_inside(const kernels::TriangleBlock& block, const Vec3& o, const Vec3& d,
                      double (&distances)[TRIANGLE_LANES]) {
    for (int lane = 0; lane < TRIANGLE_LANES; ++lane) {
        const auto corner = [&](int c) {
            return Vec3{block.corner[3 * c][lane], block.corner[3 * c + 1][lane], block.corner[3 * c + 2][lane]};
        };
        const Vec3 p = corner(0) - o, q = corner(1) - o, r = corner(2) - o;
        const double u = dot(cross(q, r), d), v = dot(cross(r, p), d), w = dot(cross(p, q), d);
        const double volume = u + v + w;
        const double t = (u * dot(p, d) + v * dot(q, d) + w * dot(r, d)) / volume;
        const bool meets = (u >= 0) & (v >= 0) & (w >= 0) & (t >= 0); // else from outside, or beside it
        distances[lane] = meets ? t : never;
    }
}

double leaves(const ShapeData& shape, const Vec3& origin, const Vec3& direction,
              std::span<const std::uint32_t> around) {
    const BoxRay ray(origin, direction);
    double nearest = never;
    std::array<std::uint32_t, NODE_LEVELS * NODE_LANES> open{0};
    for (std::size_t count = 1; count > 0;) {
        const kernels::Node& node = shape.nodes[open[--count]];
        float enters[NODE_LANES];
        ray.enter(node, enters);
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child == NONE || !(double(enters[lane]) * (1 - 1e-5) < nearest)) continue;
            if ((child & LEAF) == 0) {
                open[count++] = child;
                continue;
            }
            const kernels::TriangleBlock& block = shape.triangle_blocks[child & ~LEAF];
            double distances[TRIANGLE_LANES];
            meet_from_inside(block, origin, direction, distances);
            for (std::size_t t = 0; t < TRIANGLE_LANES; ++t)
                if (distances[t] < nearest && !std::binary_search(around.begin(), around.end(), block.triangle[t]))
                    nearest = distances[t];
        }
    }
    return nearest;
}

} // namespace

std::vector<float> measure_exits(const ShapeData& shape, std::span<const Vec3> normals, Executor& executor) {
    const VertexTriangles triangles =
        vertex_triangles(shape.mesh.triangles, static_cast<std::uint32_t>(shape.points.size()));
    std::vector<float> distances(shape.points.size(), 0.0f);
    executor.run(static_cast<std::uint32_t>(distances.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t v = begin; v < end; ++v) {
            const Vec3 n = shape.vertex_normals[v];
            if (n == Vec3{}) continue;
            // The direction that the kernels will use, so that both end at the same face.
            const Vec3 direction{-static_cast<float>(n.x), -static_cast<float>(n.y), -static_cast<float>(n.z)};
            const auto around = triangles.of(v);
            if (points_inside(shape, normals, v, direction, around))
                distances[v] = static_cast<float>(leaves(shape, shape.point(v), direction, around));
        }
    });
    return distances;
}

} // namespace raycontact
