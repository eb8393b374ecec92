// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/shape_pair.h"

#include <cstdint>
#include <optional>

namespace raycontact {

/// Whether a point, whose `rough` is in the shape's centred frame, is inside a shape that has an inside, or on its
/// surface. Exact: crossings of a segment out of the mesh are decided by the predicates of placed points.
bool is_inside(const PlacedShape& shape, const PlacedPoint& point);

/// The same of a point of the world.
bool is_inside(const ShapeData& shape, const Pose& pose, const Vec3& point);

/// A vertex of a inside b, of two whose surfaces do not meet: so each component lies inside as a whole, or not at all.
std::optional<std::uint32_t> vertex_inside(const ShapePair& pair);

} // namespace raycontact
