// SPDX-License-Identifier: Apache-2.0
#include "mesh/disjoint_sets.h"
#include "mesh/vector.h"
#include "shape/build.h"

#include <algorithm>
#include <vector>

namespace raycontact {

namespace {

// Faces whose normals differ by less than some 4e-5 are one flat face: an edge inside it never is a contact.
constexpr double flat_cosine = 1 - 1e-9;

// The tangent of half the angle by which the faces of an edge turn away from each other, at most 1; 0 of a valley.
double ridge(const ShapeData& shape, std::span<const Vec3> normals, std::uint32_t triangle, std::size_t edge) {
    const std::uint32_t across = shape.neighbours[triangle][edge];
    if (across == Shape::no_triangle) return 1;
    const Vec3 &n = normals[triangle], &m = normals[across];
    const Vec3 along = shape.corner(triangle, (edge + 1) % 3) - shape.corner(triangle, edge);
    if (dot(cross(n, m), along) < 0) return 0;
    const double turned = length(n - m), same = length(n + m);
    return turned < same ? turned / same : 1;
}

} // namespace

void find_sharp_edges(ShapeData& shape, std::span<const Vec3> normals) {
    const auto& triangles = shape.mesh.triangles;
    shape.sharp_edges.assign(triangles.size(), 0);
    shape.hides.assign(triangles.size(), {});
    shape.vertex_triangle.assign(shape.points.size(), Shape::no_triangle);
    std::vector<float> hides;
    hides.reserve(2 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t c = 0; c < 3; ++c) {
            std::uint32_t& first = shape.vertex_triangle[triangles[t][c]];
            if (first == Shape::no_triangle) first = t;
            const std::uint32_t across = shape.neighbours[t][c];
            if (across != Shape::no_triangle && across < t) continue;
            const double size = length(shape.corner(t, (c + 1) % 3) - shape.corner(t, c));
            shape.longest_edge = std::max(shape.longest_edge, size);
            shape.hides[t][c] = static_cast<float>(0.5 * size * ridge(shape, normals, t, c));
            hides.push_back(shape.hides[t][c]);
            shape.hides_most = std::max(shape.hides_most, double(shape.hides[t][c]));
            if (across == Shape::no_triangle || !(dot(normals[t], normals[across]) > flat_cosine))
                shape.sharp_edges[t] = static_cast<std::uint8_t>(shape.sharp_edges[t] | 1u << c);
        }
    }
    const auto half = hides.begin() + std::ssize(hides) / 2;
    std::ranges::nth_element(hides, half);
    if (half != hides.end()) shape.hides_half = double(*half);
}

void find_components(ShapeData& shape) {
    DisjointSets components;
    components.reset(shape.points.size());
    for (const auto& [a, b, c] : shape.mesh.triangles) {
        components.join(a, b);
        components.join(a, c);
    }
    std::vector<std::uint32_t> component_of(shape.points.size()); // by its lowest vertex
    for (std::uint32_t v = 0; v < shape.points.size(); ++v) {
        if (shape.vertex_triangle[v] == Shape::no_triangle) continue;
        const std::uint32_t lowest = components.of(v);
        const auto& [x, y, z] = shape.points[v];
        const float at[3] = {x, y, z};
        if (lowest == v) {
            component_of[v] = static_cast<std::uint32_t>(shape.components.size());
            shape.component_vertices.push_back(v);
            shape.components.push_back({{x, y, z}, {x, y, z}, {x, y, z}});
        }
        kernels::Component& own = shape.components[component_of[lowest]];
        for (std::size_t k = 0; k < 3; ++k) {
            own.low[k] = std::min(own.low[k], at[k]);
            own.high[k] = std::max(own.high[k], at[k]);
        }
    }
    shape.header.component_count = static_cast<kernels::uint>(shape.components.size());
}

} // namespace raycontact
