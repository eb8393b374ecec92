// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace raycontact::reference {

/// A mesh as the rule of contact sees it, all recomputed in double from positions and triangles alone.
/// Positions are relative to `centre`, so that a mesh far from its origin loses nothing.
struct Solid {
    std::string name;
    Vec3 centre;                ///< body frame, metres
    std::vector<Vec3> vertices; ///< body frame, minus centre
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> vertex_index;         ///< file index of each vertex
    std::vector<std::uint32_t> triangle_index;       ///< file index of each triangle
    std::vector<std::array<std::uint32_t, 2>> edges; ///< each once, lower vertex first
    std::vector<Vec3> edge_normals;                  ///< sum of the unit normals around each edge, not normalised
    std::vector<Vec3> face_normals;                  ///< unit; zero for a triangle without area
    std::vector<Vec3> vertex_normals;                ///< unit, angle-weighted; zero where they cancel out
    std::vector<double> cancellation;                ///< length of the weighted sum over the sum of the weights
    std::vector<double> vertex_areas;                ///< m^2, a third of the area of the triangles around each vertex
    std::vector<double> exits;                       ///< exit distance of each vertex, metres, may be +inf
    std::vector<double> exit_margins;                ///< how safe that is, relative to the diagonal (see exits.h)
    Vec3 box_min, box_max;                           ///< minus centre
    double diagonal = 0;                             ///< of the box, metres
    double reach = 0;    ///< largest finite exit distance; the diagonal where none is above 0
    bool closed = false; ///< every edge met an even number of times
};

/// Everything but exits, exit_margins and reach. `centre` is subtracted from the positions.
Solid make_surface(std::string name, const std::vector<Vec3>& vertices,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles, const Vec3& centre = {});

/// The whole of it, indices counting up; O(vertices x triangles).
Solid make_solid(std::string name, const std::vector<Vec3>& vertices,
                 const std::vector<std::array<std::uint32_t, 3>>& triangles, const Vec3& centre = {});

/// From the positions, triangles and index maps of a shape, and nothing else of it.
Solid make_solid(const Shape& shape);
/// The same without the exit distances.
Solid make_surface(const Shape& shape);

} // namespace raycontact::reference
