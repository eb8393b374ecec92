// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "pairs/directed_pairs.h"
#include "shape/accelerators.h"

#include <raycontact/contact.h>

#include <array>

namespace raycontact {

/// One direction of a pair for the edges' rule: the source's vertices in the target's centred frame, in double. Each is
/// moved inwards by a hair and shaken by a hundredth of it, so that aligned faces, shared vertices and coincident edges
/// decide nothing (docs/edges.md).
struct SourceMesh {
    const ShapeData& source;
    const ShapeData& target;
    const Accelerators* target_accelerators; ///< null: it has none
    Pose pose;                               ///< of the source's centred frame in the target's
    double size;                             ///< of the smaller body's box, its diagonal, metres
    double hair;                             ///< metres

    SourceMesh(const PlacedBody& from, const PlacedBody& to)
        : source(from.shape->data()), target(to.shape->data()), target_accelerators(to.shape->accelerators()),
          pose(relative_pose(to.centred, from.centred)), size(smaller_size(from, to)), hair(1e-7 * size) {}

    Vec3 turned(const Vec3& v) const {
        const auto& r = pose.rotation;
        return {(r[0] * v.x + r[1] * v.y) + r[2] * v.z, (r[3] * v.x + r[4] * v.y) + r[5] * v.z,
                (r[6] * v.x + r[7] * v.y) + r[8] * v.z};
    }
    Vec3 placed(const Vec3& v) const { return turned(v) + pose.translation; }
    /// A point of the target's frame, back in the source's.
    Vec3 back(const Vec3& p) const {
        const auto& r = pose.rotation;
        const Vec3 d = p - pose.translation;
        return {(r[0] * d.x + r[3] * d.y) + r[6] * d.z, (r[1] * d.x + r[4] * d.y) + r[7] * d.z,
                (r[2] * d.x + r[5] * d.y) + r[8] * d.z};
    }
    Vec3 vertex(std::uint32_t v) const { return placed(source.point(v) + hair * source.hair_moves[v]); }
};

/// Outward unit normal of a face, in double; zero without area.
inline Vec3 normal_of(const ShapeData& shape, std::uint32_t face) {
    const Vec3 a = shape.corner(face, 0);
    const Vec3 n = cross(shape.corner(face, 1) - a, shape.corner(face, 2) - a);
    const double size = length(n);
    return size > 0 ? (1 / size) * n : Vec3{};
}

/// Both bodies of a pair in one frame, that of b about its centre, in double: what decides, decides of one
/// configuration. Every vertex is moved inward by a hair, those of a and b shaken in opposite ways.
class PairMeshes {
public:
    PairMeshes(const PlacedBody& a, const PlacedBody& b) : a_in_b_(a, b), shapes_{&a_in_b_.source, &a_in_b_.target} {}

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
    SourceMesh a_in_b_;
    std::array<const ShapeData*, 2> shapes_;
};

/// A contact of two edges, or of a body inside another; in the target's centred frame. Of edges the source is a.
struct FeatureContact {
    VertexBody source;
    Feature feature;
    std::uint32_t index; ///< edges: the edge of a, 3 x its lowest triangle + its first corner; inside: the vertex
    std::uint32_t other; ///< edges: the edge of b; inside: the face of the target
    Vec3 point;          ///< on the source
    Vec3 normal;         ///< out of the target, unit
    double depth;
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
