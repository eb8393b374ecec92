// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "executor/executor.h"
#include "mesh/arrangement.h"
#include "mesh/mesh_tree.h"
#include "mesh/patches.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raycontact {

/// What was done about parts of a mesh that lie in each other.
struct United {
    enum class Done {
        nothing, ///< it does not cross itself, and its winding number is 0 in front and 1 behind everywhere
        union_,
        stays,    ///< nothing would be left, as of a sheet with two sides, or nothing crosses any more that can be told
        given_up, ///< it was too much work, or rounding decided
    };
    Done done = Done::nothing;
    CutMesh cut{};          ///< the surface of what has a winding number of at least 1
    std::size_t split = 0;  ///< triangles
    std::size_t buried = 0; ///< triangles that are gone as a whole
};

/// The union of the solids that a mesh is made of: cuts triangles where they cross each other, and leaves out the
/// pieces that do not have a winding number of 0 or less in front and of 1 or more behind. Of pieces that lie on each
/// other one stays. Points are rounded to double, so the union may cross itself again, by a rounding: then `again`,
/// with which points nearer than `near` metres become one; so they do where it cannot be told otherwise what stays.
/// The mesh must be closed and wound alike everywhere; patches: its own; exact: its vertices, snapped(); tree: over its
/// triangles that have an area.
United unite(const PreparedMesh& mesh, const Patches& patches, std::span<const Vec3> exact, const MeshTree& tree,
             double near, bool again, Executor& executor);

} // namespace raycontact
