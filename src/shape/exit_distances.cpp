// SPDX-License-Identifier: Apache-2.0
#include "shape/exit_distances.h"

#include "mesh/adjacency.h"
#include "mesh/vector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

Vec3 to_double(const Point3f& p) {
    return {p.x, p.y, p.z};
}

// Ray in double precision against one triangle met from inside; infinity otherwise. Edges belong to the triangle.
double distance_from_inside(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 p = a - origin, q = b - origin, r = c - origin;
    const double u = dot(cross(q, r), direction), v = dot(cross(r, p), direction), w = dot(cross(p, q), direction);
    constexpr double never = std::numeric_limits<double>::infinity();
    if (u < 0 || v < 0 || w < 0) return never; // from outside, or beside it
    const double volume = u + v + w;
    if (volume == 0) return never;
    const double t = (u * dot(p, direction) + v * dot(q, direction) + w * dot(r, direction)) / volume;
    return t >= 0 ? t : never;
}

class OwnMesh {
public:
    OwnMesh(const ShapeData& shape, std::span<const Vec3> face_normals) : shape_(shape), face_normals_(face_normals) {}

    // Which side of the faces around the vertex does the direction leave on? The closest feature of their infinite
    // wedges decides by its pseudo-normal (Baerentzen and Aanaes 2005): a face, an edge, or the vertex itself.
    bool points_inside(std::uint32_t vertex, const Vec3& direction, std::span<const std::uint32_t> around) const {
        const Vec3 origin = to_double(shape_.points[vertex]);
        double best = 0; // cosine to the closest feature; none in front of the direction: the apex, which is inside
        Vec3 normal = shape_.vertex_normals[vertex];
        for (const std::uint32_t t : around) {
            if (face_normals_[t] == Vec3{}) continue;
            const auto& corners = shape_.mesh.triangles[t];
            const int c = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
            const Vec3 n = face_normals_[t];
            Vec3 e1 = to_double(shape_.points[corners[(c + 1) % 3]]) - origin;
            Vec3 e2 = to_double(shape_.points[corners[(c + 2) % 3]]) - origin;
            e1 = (1 / length(e1)) * e1;
            e2 = (1 / length(e2)) * e2;
            const Vec3 flat = direction - dot(direction, n) * n;
            if (dot(cross(e1, flat), n) > 0 && dot(cross(flat, e2), n) > 0) {
                consider(length(flat), n, best, normal);
            } else {
                consider(dot(direction, e1), edge_normal(t, c), best, normal);
                consider(dot(direction, e2), edge_normal(t, (c + 2) % 3), best, normal);
            }
        }
        return dot(direction, normal) < 0;
    }

    double leave(std::uint32_t vertex, const Vec3& direction, std::span<const std::uint32_t> around) const {
        const Vec3 origin = to_double(shape_.points[vertex]);
        double nearest = std::numeric_limits<double>::infinity();
        std::vector<std::uint32_t> open{0};
        while (!open.empty()) {
            const kernels::Node& node = shape_.nodes[open.back()];
            open.pop_back();
            for (int lane = 0; lane < NODE_LANES; ++lane) {
                if (node.child[lane] == NONE) continue;
                const double at = enters(node, lane, origin, direction);
                if (at > nearest || std::isinf(at)) continue;
                if ((node.child[lane] & LEAF) == 0) {
                    open.push_back(node.child[lane]);
                    continue;
                }
                for (const kernels::uint t : shape_.triangle_blocks[node.child[lane] & ~LEAF].triangle) {
                    if (t == NONE || std::binary_search(around.begin(), around.end(), t)) continue;
                    const auto& [a, b, c] = shape_.mesh.triangles[t];
                    nearest = std::min(nearest,
                                       distance_from_inside(origin, direction, to_double(shape_.points[a]),
                                                            to_double(shape_.points[b]), to_double(shape_.points[c])));
                }
            }
        }
        return nearest;
    }

private:
    static void consider(double cosine, const Vec3& candidate, double& best, Vec3& normal) {
        if (cosine > best) {
            best = cosine;
            normal = candidate;
        }
    }

    Vec3 edge_normal(std::uint32_t triangle, int edge) const {
        const std::uint32_t across = shape_.neighbours[triangle][edge];
        return across == Shape::no_triangle ? face_normals_[triangle] : face_normals_[triangle] + face_normals_[across];
    }

    // Distance at which the ray enters the box, infinity when it misses.
    static double enters(const kernels::Node& node, int lane, const Vec3& origin, const Vec3& direction) {
        const double o[3] = {origin.x, origin.y, origin.z}, d[3] = {direction.x, direction.y, direction.z};
        double enter = 0, leave = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const double low = node.bounds[axis][lane], high = node.bounds[3 + axis][lane];
            if (d[axis] == 0) {
                if (o[axis] < low || o[axis] > high) return std::numeric_limits<double>::infinity();
                continue;
            }
            const double t0 = (low - o[axis]) / d[axis], t1 = (high - o[axis]) / d[axis];
            enter = std::max(enter, std::min(t0, t1));
            leave = std::min(leave, std::max(t0, t1));
        }
        return enter <= leave ? enter : std::numeric_limits<double>::infinity();
    }

    const ShapeData& shape_;
    std::span<const Vec3> face_normals_;
};

} // namespace

std::vector<float> measure_exits(const ShapeData& shape, std::span<const Vec3> face_normals) {
    const VertexTriangles around =
        vertex_triangles(shape.mesh.triangles, static_cast<std::uint32_t>(shape.points.size()));
    const OwnMesh own(shape, face_normals);
    std::vector<float> distances(shape.points.size(), 0.0f);
    for (std::uint32_t v = 0; v < distances.size(); ++v) {
        const Vec3 n = shape.vertex_normals[v];
        if (n == Vec3{}) continue;
        // The direction that the kernels will use, so that both end at the same face.
        const Vec3 direction{-static_cast<float>(n.x), -static_cast<float>(n.y), -static_cast<float>(n.z)};
        const auto incident = around.of(v);
        if (!own.points_inside(v, direction, incident)) continue;
        distances[v] = static_cast<float>(own.leave(v, direction, incident));
    }
    return distances;
}

} // namespace raycontact
