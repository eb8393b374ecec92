// SPDX-License-Identifier: Apache-2.0
#include "reference/solid.h"

#include "reference/exits.h"
#include "reference/vector.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace raycontact::reference {

namespace {

void add_edges(Solid& solid) {
    struct Around {
        Vec3 normal;
        int count = 0;
    };
    std::map<std::array<std::uint32_t, 2>, Around> edges;
    for (std::size_t t = 0; t < solid.triangles.size(); ++t) {
        const auto& triangle = solid.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
            auto& around = edges[{low, high}];
            around.normal = around.normal + solid.face_normals[t];
            ++around.count;
        }
    }
    solid.closed = !edges.empty();
    for (const auto& [edge, around] : edges) {
        solid.edges.push_back(edge);
        solid.edge_normals.push_back(around.normal);
        if (around.count % 2 != 0) solid.closed = false;
    }
}

void add_vertex_normals(Solid& solid) {
    std::vector<Vec3> sums(solid.vertices.size());
    std::vector<double> weights(solid.vertices.size(), 0.0);
    for (std::size_t t = 0; t < solid.triangles.size(); ++t) {
        const auto& triangle = solid.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& apex = solid.vertices[triangle[k]];
            const Vec3 left = solid.vertices[triangle[(k + 1) % 3]] - apex;
            const Vec3 right = solid.vertices[triangle[(k + 2) % 3]] - apex;
            const double angle = std::atan2(length(cross(left, right)), dot(left, right));
            sums[triangle[k]] = sums[triangle[k]] + angle * solid.face_normals[t];
            weights[triangle[k]] += angle;
        }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const double ratio = weights[v] > 0 ? length(sums[v]) / weights[v] : 0;
        solid.cancellation.push_back(ratio);
        solid.vertex_normals.push_back(ratio > 1e-12 ? unit(sums[v]) : Vec3{});
    }
}

void add_vertex_areas(Solid& solid) {
    solid.vertex_areas.resize(solid.vertices.size(), 0.0);
    for (const auto& t : solid.triangles) {
        const Vec3 normal =
            cross(solid.vertices[t[1]] - solid.vertices[t[0]], solid.vertices[t[2]] - solid.vertices[t[0]]);
        for (const std::uint32_t v : t) solid.vertex_areas[v] += length(normal) / 6;
    }
}

void add_box(Solid& solid) {
    const double inf = std::numeric_limits<double>::infinity();
    solid.box_min = {inf, inf, inf};
    solid.box_max = {-inf, -inf, -inf};
    for (const Vec3& v : solid.vertices) {
        solid.box_min = {std::min(solid.box_min.x, v.x), std::min(solid.box_min.y, v.y),
                         std::min(solid.box_min.z, v.z)};
        solid.box_max = {std::max(solid.box_max.x, v.x), std::max(solid.box_max.y, v.y),
                         std::max(solid.box_max.z, v.z)};
    }
    solid.diagonal = length(solid.box_max - solid.box_min);
}

} // namespace

Solid make_surface(std::string name, const std::vector<Vec3>& vertices,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles, const Vec3& centre) {
    Solid solid;
    solid.name = std::move(name);
    solid.centre = centre;
    for (const Vec3& v : vertices) solid.vertices.push_back(v - centre);
    solid.triangles = triangles;
    solid.vertex_index.resize(vertices.size());
    solid.triangle_index.resize(triangles.size());
    std::iota(solid.vertex_index.begin(), solid.vertex_index.end(), 0u);
    std::iota(solid.triangle_index.begin(), solid.triangle_index.end(), 0u);
    for (const auto& t : triangles) {
        const Vec3 a = solid.vertices[t[0]];
        solid.face_normals.push_back(unit(cross(solid.vertices[t[1]] - a, solid.vertices[t[2]] - a)));
    }
    add_edges(solid);
    add_vertex_normals(solid);
    add_vertex_areas(solid);
    add_box(solid);
    return solid;
}

Solid make_solid(std::string name, const std::vector<Vec3>& vertices,
                 const std::vector<std::array<std::uint32_t, 3>>& triangles, const Vec3& centre) {
    Solid solid = make_surface(std::move(name), vertices, triangles, centre);
    add_exits(solid);
    return solid;
}

} // namespace raycontact::reference
