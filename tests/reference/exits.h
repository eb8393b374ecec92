// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/solid.h"

namespace raycontact::reference {

/// Fills exits, exit_margins and reach: how far the ray from each vertex along its inward normal travels inside its
/// own mesh. The margin is the smaller of the ray's distance to an edge up to its exit and of the direction's
/// distance to the cone of triangles around the vertex, relative to the diagonal: below 1e-5, rounding may decide.
void add_exits(Solid& solid);

} // namespace raycontact::reference
