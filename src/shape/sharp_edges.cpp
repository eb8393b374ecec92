// SPDX-License-Identifier: Apache-2.0
#include "mesh/vector.h"
#include "shape/build.h"

#include <numeric>

namespace raycontact {

namespace {

// Faces whose normals differ by less than some 4e-5 are one flat face: an edge inside it never decides a contact.
constexpr double flat_cosine = 1 - 1e-9;

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

} // namespace

void find_sharp_edges(ShapeData& shape, std::span<const Vec3> normals) {
    const auto& triangles = shape.mesh.triangles;
    shape.sharp_edges.assign(triangles.size(), 0);
    shape.vertex_triangle.assign(shape.points.size(), Shape::no_triangle);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t c = 0; c < 3; ++c) {
            std::uint32_t& first = shape.vertex_triangle[triangles[t][c]];
            if (first == Shape::no_triangle) first = t;
            const std::uint32_t across = shape.neighbours[t][c];
            if (across != Shape::no_triangle && (across < t || dot(normals[t], normals[across]) > flat_cosine))
                continue;
            shape.sharp_edges[t] = static_cast<std::uint8_t>(shape.sharp_edges[t] | 1u << c);
        }
    }
}

void find_components(ShapeData& shape) {
    std::vector<std::uint32_t> parents(shape.points.size());
    std::iota(parents.begin(), parents.end(), 0u);
    for (const auto& [a, b, c] : shape.mesh.triangles)
        for (const std::uint32_t v : {b, c}) {
            const std::uint32_t p = root_of(parents, a), q = root_of(parents, v);
            parents[std::max(p, q)] = std::min(p, q); // so that a root is the lowest of its component
        }
    for (std::uint32_t v = 0; v < parents.size(); ++v)
        if (parents[v] == v && shape.vertex_triangle[v] != Shape::no_triangle) shape.component_vertices.push_back(v);
}

} // namespace raycontact
