// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"
#include "shape/accelerators.h"
#include "shape/mesh_rays.h"

#include <raycontact/contact.h>

#include <array>

namespace raycontact {

/// One direction of a pair for the edges' rule: the source's vertices in the target's centred frame, in double. Each is
/// moved inwards by a perturbation and shaken by a hundredth of it, so that aligned faces, shared vertices and
/// coincident edges decide nothing (docs/internals/edges.md).
struct SourceMesh {
    const ShapeData& source;
    const ShapeData& target;
    const Accelerators* target_accelerators; ///< null: it has none
    Pose pose;                               ///< of the source's centred frame in the target's
    double size;                             ///< of the smaller body's box, its diagonal, metres
    double perturbation;                     ///< metres

    SourceMesh(const PlacedBody& from, const PlacedBody& to)
        : source(from.shape->data()), target(to.shape->data()), target_accelerators(accelerators_of(*to.shape)),
          pose(relative_pose(to.centred, from.centred)), size(smaller_size(from, to)), perturbation(1e-7 * size) {}

    Vec3 turned(const Vec3& v) const { return rotated(pose.rotation, v); }
    Vec3 placed(const Vec3& v) const { return turned(v) + pose.translation; }
    /// A point of the target's frame, back in the source's.
    Vec3 back(const Vec3& p) const { return rotated_back(pose.rotation, p - pose.translation); }
    Vec3 vertex(std::uint32_t v) const { return placed(source.point(v) + perturbation * source.perturbations[v]); }
};

/// Both bodies of a pair in one frame, that of b about its centre, in double: what decides, decides of one
/// configuration. Every vertex is moved inward by a perturbation, those of a and b shaken in opposite ways.
class PairMeshes {
public:
    /// of_file: unmoved vertices are those of the file, as queries see them; else those of steps, rounded to float32.
    PairMeshes(const PlacedBody& a, const PlacedBody& b, bool of_file = false)
        : a_in_b_(a, b), shapes_{&a_in_b_.source, &a_in_b_.target}, of_file_(of_file) {}

    const ShapeData& shape(std::size_t side) const { return *shapes_[side]; }
    double perturbation() const { return a_in_b_.perturbation; }
    /// Of the smaller body's box, its diagonal.
    double size() const { return a_in_b_.size; }

    /// Neither mesh has an inside: what is behind a surface counts as in it.
    bool of_sheets() const { return !closed(0) && !closed(1); }
    /// Whether an edge can be in a body: in a closed one; in an open one if the other is open, too.
    bool holds_edges(std::size_t side) const { return closed(side) || of_sheets(); }

    Vec3 vertex(std::size_t side, std::uint32_t v) const {
        const ShapeData& own = *shapes_[side];
        if (side == 0) return a_in_b_.vertex(v);
        return own.point(v) - perturbation() * (own.perturbations[v] + 4.0 * own.vertex_normals[v]);
    }
    /// Without the perturbation.
    Vec3 unmoved_vertex(std::size_t side, std::uint32_t v) const {
        const ShapeData& own = *shapes_[side];
        const Vec3 p = (of_file_ ? own.file_vertex(v) : own.mesh.vertices[v]) - own.centre;
        return side == 0 ? a_in_b_.placed(p) : p;
    }
    /// The origin of a body's centred frame.
    Vec3 centre(std::size_t side) const { return side == 0 ? a_in_b_.pose.translation : Vec3{}; }
    Vec3 corner(std::size_t side, std::uint32_t face, std::size_t k) const {
        return vertex(side, shapes_[side]->mesh.triangles[face][k]);
    }
    /// Outward unit normal of a face; zero without area.
    Vec3 normal(std::size_t side, std::uint32_t face) const {
        const Vec3 n = unit(area_normal(*shapes_[side], face));
        return side == 0 ? a_in_b_.turned(n) : n;
    }
    /// A direction of a body's own frame, in that of the pair.
    Vec3 direction_from(std::size_t side, const Vec3& d) const { return side == 0 ? a_in_b_.turned(d) : d; }
    /// A point or a direction, in a body's own frame.
    Vec3 point_in(std::size_t side, const Vec3& p) const { return side == 0 ? a_in_b_.back(p) : p; }
    Vec3 direction_in(std::size_t side, const Vec3& d) const {
        return side == 0 ? a_in_b_.back(d + a_in_b_.pose.translation) : d;
    }

private:
    bool closed(std::size_t side) const { return shapes_[side]->header.closed != 0; }

    SourceMesh a_in_b_;
    std::array<const ShapeData*, 2> shapes_;
    bool of_file_;
};

/// A contact that was found on the host, in the target's centred frame. Of edges the source is a.
struct FeatureContact {
    Side source;
    FeatureKind kind;
    std::uint32_t index; ///< edges: the edge of a, 3 x its lowest triangle + its first corner; else the vertex
    std::uint32_t other; ///< edges: the edge of b; else the face of the target
    Vec3 point;          ///< on the source
    Vec3 normal;         ///< out of the target, unit
    double depth;
    double when = 0; ///< the part of the step after which they meet: the target, and the normal with it, turns so far
};

/// Whether a point lies in a closed mesh, by a ray; centred frame.
inline bool encloses(const ShapeData& mesh, const Vec3& p) {
    if (!box_of(mesh).touches({p, p})) return false;
    // Any direction serves; this one is related to no axis and no diagonal.
    const MeshHit hit = closest_hit(mesh, {p, {0.5402, 0.3173, 0.7794}, 0, 1e300});
    return hit.face != NONE && hit.from_inside;
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

/// Whether its faces are not flush, or it is a border. edge: by its lowest triangle; false by any other.
inline bool is_sharp(const ShapeData& shape, std::uint32_t edge) {
    return (shape.sharp_edges[edge / 3] >> (edge % 3) & 1u) != 0;
}
/// How deep an overlap can be that it alone crosses, metres (docs/internals/edges.md). edge: by its lowest triangle.
inline double hidden_by(const ShapeData& shape, std::uint32_t edge) {
    return shape.hides[edge / 3][edge % 3];
}
/// Whether the far corner of the one face lies below the other. Borders count as convex.
inline bool is_convex(const ShapeData& shape, std::uint32_t edge) {
    const auto [own, across] = faces_of(shape, edge);
    if (across == NONE) return true;
    const auto [start, stop] = ends_of(shape, edge);
    const Vec3 n = unit(area_normal(shape, own)), from = shape.point(start);
    for (const std::uint32_t v : shape.mesh.triangles[across])
        if (v != start && v != stop && dot(shape.point(v) - from, n) > 0) return false;
    return true;
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
