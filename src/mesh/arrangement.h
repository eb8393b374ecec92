// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/subdivision.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace raycontact {

/// The triangles of a mesh, those that cross others cut there.
struct CutMesh {
    std::vector<Vec3> vertices;      ///< those of the mesh, then those where triangles cross
    std::vector<Triangle> triangles; ///< in the order of the mesh; the pieces of one follow each other
    std::vector<std::uint32_t> of;   ///< the triangle that each one is, or is a piece of
};

/// Cuts the triangles of a mesh at each other. Where they cross is computed in rational numbers.
class Arrangement {
public:
    /// exact: the mesh's vertices, snapped().
    Arrangement(const PreparedMesh& mesh, std::span<const Vec3> exact);

    /// At what the two of each pair share; none may lack an area. False if that is too much work.
    bool cut(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
    /// Points are rounded to double. One that is nearer than `tolerance` metres to a vertex, or to one before it, is
    /// that.
    CutMesh list(double tolerance) const;

private:
    std::uint32_t point_of(std::uint32_t vertex);
    Subdivision& subdivision_of(std::uint32_t t);
    std::array<Vec3, 3> corners_of(std::uint32_t t) const;
    void meet(std::uint32_t i, std::uint32_t k);
    void add_crossings(std::uint32_t t, const std::array<int, 3>& sides, std::uint32_t other,
                       std::vector<std::uint32_t>& found);
    void overlap(std::uint32_t t, std::uint32_t other);
    void add_line(std::vector<std::uint32_t>& points, Subdivision& to);

    const PreparedMesh& mesh_;
    std::span<const Vec3> exact_;
    PointTable table_;
    std::size_t work_ = 0;                                                  ///< what may still be done
    std::unordered_map<std::uint32_t, std::uint32_t> point_of_, vertex_of_; ///< of vertices, and back
    std::map<std::uint32_t, Subdivision> subdivisions_;                     ///< by triangle
    std::map<std::uint32_t, std::vector<Triangle>> pieces_;
};

} // namespace raycontact
