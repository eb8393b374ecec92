// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/adjacency.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// The triangles of a polygon of at least 3 corners, as PolygonCutter has them, by the corners' numbers; none where the
/// fan of the first corner would have to stay. Corners are exact for predicates (snapped()).
std::vector<Triangle> cut_polygon(std::span<const Vec3> corners);

/// Cuts the polygons of a file into triangles: n - 2 of a polygon of n corners, so that a file's triangles can be
/// counted without knowing where they lie. It is the fan of the first corner where all triangles of the fan have an
/// area and face the way the polygon does, as those of every convex polygon without a corner on a straight side. Else
/// ears are cut off, seen along the axis that is closest to the polygon's normal. Where that ends nowhere, as it may if
/// the polygon crosses itself or has no area, the fan stays.
class PolygonCutter {
public:
    /// Appends the triangles of a polygon of at least 3 corners. One with vertices that the mesh does not have yet
    /// waits for finish().
    void append(Mesh& mesh, std::span<const std::uint32_t> corners);
    /// When all vertices are read. A corner that is no vertex is left to check_mesh().
    void finish(Mesh& mesh) const;

private:
    std::vector<std::pair<std::size_t, std::size_t>> waiting_; ///< first triangle, corners
};

} // namespace raycontact
