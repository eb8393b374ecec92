// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Fills `clearances` and its part of the header: for the middle of each cubic cell of the box, a length within which
/// there is certainly no surface, rounded down to a byte, and whether the middle is certainly outside (closed, outward
/// meshes only). From one look-up follows how far a vertex can move before it could touch (docs/certified.md). No
/// contact is made from it; a coarser grid only makes pairs wake up earlier. Meshes of needles longer than a grid is
/// worth get none.
void build_clearance_grid(ShapeData& shape);

} // namespace raycontact
