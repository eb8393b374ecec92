// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "pairs/directed_pairs.h"
#include "shape/accelerators.h"

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

} // namespace raycontact
