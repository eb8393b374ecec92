// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>
#include <optional>

namespace raycontact::scenes {

/// What a scene asks of its meshes: closed, manifold, oriented, outward, one piece, free of self-intersections.
bool sound(const MeshReport& report);

/// A closed mesh reduced to exactly `triangles` (even): meshoptimizer's edge collapses to that count or a little below,
/// flaps removed, then the longest edges split at their middles, which changes no surface. Every try is checked by
/// prepare_mesh; nothing when none is sound.
std::optional<Mesh> simplify_to(const PreparedMesh& mesh, std::uint32_t triangles);

} // namespace raycontact::scenes
