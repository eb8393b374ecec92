// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"

#include <span>

namespace raycontact {

/// Whether two triangles meet elsewhere than in the vertices or the edge they share. Exact for vertices as given (see
/// predicates.h), which are equal exactly where their indices are. Neither may be degenerate.
bool triangles_meet(std::span<const Vec3> vertices, const Triangle& a, const Triangle& b);

} // namespace raycontact
