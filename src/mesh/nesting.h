// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/mesh_tree.h"
#include "mesh/patches.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// Which patches must be turned, once the windings of each agree, so that it is as `nesting` has it: an outer surface
/// encloses a positive volume, a cavity a negative one. Patches that are open, not orientable or without volume stay as
/// they are, and those for which it would take too long to find what lies around them.
struct Turns {
    std::vector<char> patches; ///< whether each is one
    std::size_t unknown = 0;   ///< patches for which it would take too long
};
Turns patches_to_turn(const PreparedMesh& mesh, const Patches& patches, const LazyTree& tree, Nesting nesting);

/// The winding number of a closed mesh in front of a point of a triangle, and of others that lie on it there,
/// `without`, among which it is; nothing where rounding could change it.
std::optional<int> winding_in_front(std::uint32_t triangle, const Vec3& point, const PreparedMesh& mesh,
                                    const MeshTree& tree, std::span<const std::uint32_t> without);

/// For each patch that winds inward the innermost solid around it, of which it is a cavity; for others the patch
/// itself. nullopt where it would take too long to find them. For meshes that patches_to_turn() had turned.
std::optional<std::vector<std::uint32_t>> solids_around(const PreparedMesh& mesh, const Patches& patches,
                                                        const LazyTree& tree);

/// Whether the winding number of a closed, oriented mesh without self-intersections is 0 outside and 1 inside
/// everywhere.
bool winds_outward(const PreparedMesh& mesh, const Patches& patches, const MeshTree& tree);

} // namespace raycontact
