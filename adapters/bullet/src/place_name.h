// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <candidate.h>
#include <objects.h>

namespace raycontact::bullet {

/// What Bullet calls places on a leaf: of a mesh, sub-part and triangle; -1, -1 of other shapes. triangle: as
/// Candidate::triangle.
PlaceName name_of_triangle(const Leaf& leaf, int triangle);
/// The lowest triangle at a vertex or edge, which key names.
PlaceName name_of_feature(const Leaf& leaf, const PointKey& key);

} // namespace raycontact::bullet
