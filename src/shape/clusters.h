// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/shape_data.h"

namespace raycontact {

/// Fills vertex_blocks with the vertices that can cast a ray (a normal, an exit distance above 0), sixteen neighbours
/// a block, and clusters with the boxes of an implicit sixteen-wide tree above them. Deterministic.
void build_clusters(ShapeData& shape);

} // namespace raycontact
