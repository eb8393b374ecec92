// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

namespace raycontact {

struct ShapeData;

/// How often a closed mesh winds around a point: 0 outside of it, 1 inside of one wound outward and on its surface.
/// Exact: each crossing of a ray is decided by exact predicates. `point` in the shape's centred frame.
int winding_number(const ShapeData& shape, const Vec3& point);

} // namespace raycontact
