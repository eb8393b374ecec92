// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/loops.h"

namespace raycontact::clash {

/// Whether the body of a side (0 a, 1 b) falls apart where the other is taken out of it: the surface of the rest has
/// more pieces with loops than the body's surface has. Both have an inside, and all loops are closed and there.
bool falls_apart(const PairMeshes& pair, const Loops& loops, std::size_t side);

} // namespace raycontact::clash
