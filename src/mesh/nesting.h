// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include "mesh/mesh_tree.h"
#include "mesh/patches.h"

#include <vector>

namespace raycontact {

/// Whether each patch must be turned, once its windings agree, so that it is as `nesting` has it: an outer surface
/// encloses a positive volume, a cavity a negative one. Patches that are open, not orientable or without volume stay as
/// they are.
std::vector<char> patches_to_turn(const PreparedMesh& mesh, const Patches& patches, const LazyTree& tree,
                                  Nesting nesting);

/// Whether the winding number of a closed, oriented mesh without self-intersections is 0 outside and 1 inside
/// everywhere.
bool winds_outward(const PreparedMesh& mesh, const Patches& patches, const MeshTree& tree);

} // namespace raycontact
