// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/shape_pair.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace raycontact {

/// A triangle of each shape and a point on each, in the centred frame of b.
struct TrianglePair {
    std::uint32_t a = NONE, b = NONE;
    Vec3 point_a, point_b;
};

/// A triangle of each shape.
struct MeetingTriangles {
    std::uint32_t a, b;
};
/// The first triangles found that meet, exactly.
std::optional<MeetingTriangles> meeting_triangles(const ShapePair& pair);

/// Visits triangles of which one each has a box, widened by rounding, that touches the other's. In any order, each
/// once.
void each_touching_pair(const ShapePair& pair, const std::function<void(std::uint32_t a, std::uint32_t b)>& visit);

/// The closest triangles of two shapes whose surfaces do not meet, if they are not farther apart than `farthest`,
/// metres, give or take a rounding.
std::optional<TrianglePair> closest_triangles(const ShapePair& pair, double farthest);

} // namespace raycontact
