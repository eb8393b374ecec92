// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Fills outside_cells and the grid of the header: a bit for each cubic cell of the box, set when the whole cell, grown
/// by the rounding of a look-up, lies outside the mesh. A vertex there cannot be in contact, whatever its ray, since
/// the first face that it meets is met from outside. Only for meshes whose winding number is 0 outside and 1 inside
/// everywhere (report.outward); others, and meshes of needles
/// longer than a grid is worth, get no grid and lose nothing but time. No distance is stored: nothing depends on
/// the resolution but how many rays need not be cast.
void build_outside_grid(ShapeData& shape);

} // namespace raycontact
