// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Calls visit(triangle, corner) for the triangles at a vertex, which is that corner of theirs; until one is true.
template <class Visit>
bool any_triangle_at(const ShapeData& shape, std::uint32_t vertex, Visit&& visit) {
    constexpr int most_triangles = 256;
    const std::uint32_t begin = shape.vertex_triangle[vertex];
    if (begin == Shape::no_triangle) return false;
    // Around the vertex; where a border ends that, the other way round, too.
    for (const std::uint32_t way : {0u, 2u}) {
        std::uint32_t t = begin;
        for (int count = 0; count < most_triangles && t != NONE; ++count) {
            const auto& corners = shape.mesh.triangles[t];
            const std::uint32_t c = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
            if (visit(t, c)) return true;
            t = shape.neighbours[t][(c + way) % 3];
            if (t == begin) return false;
        }
    }
    return false;
}

/// Calls visit(neighbour) for the vertices that a vertex shares an edge with, most of them twice; until one is true.
template <class Visit>
bool any_neighbour(const ShapeData& shape, std::uint32_t vertex, Visit&& visit) {
    return any_triangle_at(shape, vertex, [&](std::uint32_t t, std::uint32_t c) {
        const auto& corners = shape.mesh.triangles[t];
        return visit(corners[(c + 1) % 3]) || visit(corners[(c + 2) % 3]);
    });
}

} // namespace raycontact
