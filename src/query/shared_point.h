// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/placed_point.h"

#include <array>

namespace raycontact {

/// A point of two triangles that meet (triangles_meet()), to rounding, in the frame of their rough points.
Vec3 shared_point(const std::array<PlacedPoint, 3>& p, const std::array<PlacedPoint, 3>& q);

} // namespace raycontact
