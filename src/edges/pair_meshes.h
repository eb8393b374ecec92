// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/source_mesh.h"

#include <array>

namespace raycontact {

/// Both bodies of a pair in one frame, that of b about its centre, in double: what decides, decides of one
/// configuration. Every vertex is moved inward by a hair, those of a and b shaken in opposite ways.
class PairMeshes {
public:
    /// placed: a in b, b in a. Must outlive this.
    explicit PairMeshes(const std::array<SourceMesh, 2>& placed)
        : a_in_b_(placed[0]), shapes_{&placed[0].source, &placed[1].source} {}

    const ShapeData& shape(std::size_t side) const { return *shapes_[side]; }
    double hair() const { return a_in_b_.hair; }
    /// Of the smaller body's box, its diagonal.
    double size() const { return a_in_b_.size; }

    Vec3 vertex(std::size_t side, std::uint32_t v) const {
        const ShapeData& own = *shapes_[side];
        if (side == 0) return a_in_b_.vertex(v);
        return own.point(v) - hair() * (own.hair_moves[v] + 2.0 * own.vertex_normals[v]);
    }
    Vec3 corner(std::size_t side, std::uint32_t face, std::size_t k) const {
        return vertex(side, shapes_[side]->mesh.triangles[face][k]);
    }
    /// Outward unit normal of a face; zero without area.
    Vec3 normal(std::size_t side, std::uint32_t face) const {
        const Vec3 n = normal_of(*shapes_[side], face);
        return side == 0 ? a_in_b_.turned(n) : n;
    }
    /// A point or a direction, in a body's own frame.
    Vec3 point_in(std::size_t side, const Vec3& p) const { return side == 0 ? a_in_b_.back(p) : p; }
    Vec3 direction_in(std::size_t side, const Vec3& d) const {
        return side == 0 ? a_in_b_.back(d + a_in_b_.pose.translation) : d;
    }

private:
    const SourceMesh& a_in_b_;
    std::array<const ShapeData*, 2> shapes_;
};

/// Zero for a zero vector.
inline Vec3 unit(const Vec3& v) {
    const double size = length(v);
    return size > 0 ? (1 / size) * v : Vec3{};
}

/// An edge of a shape, 3 x its lowest triangle + its first corner there.
struct EdgeFaces {
    std::uint32_t own, across; ///< across: NONE at a border
};
inline EdgeFaces faces_of(const ShapeData& shape, std::uint32_t edge) {
    return {edge / 3, shape.neighbours[edge / 3][edge % 3]};
}
inline std::array<std::uint32_t, 2> ends_of(const ShapeData& shape, std::uint32_t edge) {
    const auto& corners = shape.mesh.triangles[edge / 3];
    return {corners[edge % 3], corners[(edge % 3 + 1) % 3]};
}

/// The edge of a face from its k-th corner to the next.
inline std::uint32_t edge_of(const ShapeData& shape, std::uint32_t face, std::uint32_t k) {
    const std::uint32_t across = shape.neighbours[face][k];
    if (across == NONE || across > face) return 3 * face + k;
    const auto& own = shape.mesh.triangles[face];
    for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t p = shape.mesh.triangles[across][i], q = shape.mesh.triangles[across][(i + 1) % 3];
        if (shape.neighbours[across][i] == face
            && ((p == own[(k + 1) % 3] && q == own[k]) || (p == own[k] && q == own[(k + 1) % 3])))
            return 3 * across + i;
    }
    return 3 * face + k;
}

} // namespace raycontact
