// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/mesh_tree.h"
#include "mesh/patches.h"

#include <atomic>
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

/// Winding numbers of a closed mesh, by rays. From several threads.
class Winding {
public:
    Winding(const PreparedMesh& mesh, const MeshTree& tree) : mesh_(mesh), tree_(tree) {}

    /// In front of a point of a triangle, and of others that lie on it there, `without`, among which it is; nothing
    /// where rounding could change it.
    std::optional<int> in_front_of(std::uint32_t triangle, const Vec3& point,
                                   std::span<const std::uint32_t> without) const;
    /// All rays together met too many triangles, as those of a million shells in each other would: then no more are
    /// cast.
    bool is_too_much() const { return looked_at_ > (std::size_t{1} << 26) + 1024 * mesh_.triangles.size(); }

private:
    const PreparedMesh& mesh_;
    const MeshTree& tree_;
    mutable std::atomic<std::size_t> looked_at_ = 0;
};

/// For each patch that winds inward the innermost solid around it, of which it is a cavity; for others the patch
/// itself. nullopt where it would take too long to find them. For meshes that patches_to_turn() had turned.
std::optional<std::vector<std::uint32_t>> solids_around(const PreparedMesh& mesh, const Patches& patches,
                                                        const LazyTree& tree);

/// Whether the winding number of a closed, oriented mesh without self-intersections is 0 outside and 1 inside
/// everywhere.
bool winds_outward(const PreparedMesh& mesh, const Patches& patches, const MeshTree& tree);

} // namespace raycontact
