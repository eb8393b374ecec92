// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <clash/parts.h>

namespace raycontact::clash {

/// How near copies lie to each other, and how far one is moved to ask how deep they are in each other: as a part of the
/// size of the mesh.
constexpr double duplicate_tolerance = 1e-6;

/// Whether one part is a copy of the other in the same place: as many vertices and triangles, and every vertex of one
/// where the other has one. Both have shapes.
bool are_duplicates(const Part& a, const Part& b);

/// The pose of a part moved aside by twice the tolerance.
Pose moved_aside(const Part& part);

} // namespace raycontact::clash
