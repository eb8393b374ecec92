// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Fills `clearances` and its part of the header: for each cubic cell around the shape the largest useful ball that no
/// surface enters, and whether it is certainly outside (closed, outward meshes only). From one look-up follows how far
/// a vertex can move before it could touch (docs/certified.md). No contact is made from it; a coarser grid only makes
/// pairs wake up earlier.
void build_clearance_grid(ShapeData& shape);

} // namespace raycontact
