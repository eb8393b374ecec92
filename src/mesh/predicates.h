// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <cstddef>
#include <span>
#include <vector>

namespace raycontact {

// Exact signs (-1, 0, 1) for coordinates that are 0 or have a magnitude in [1e-60, 1e9]: a filter in double, then
// error-free expansions (Shewchuk 1997). See snapped().

/// Side of d of the plane through a, b, c: 1 where a, b, c look clockwise from d.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Turn of a, b, c seen along coordinate axis `drop` (projected onto the other two, in cyclic order): 1 is left.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t drop);

/// Of a and b along axis k: -1 where a comes first, 0 where they are equal there.
int order(const Vec3& a, const Vec3& b, std::size_t k);

/// The sign of direction . ((a - origin) x (b - origin)): on which side the line passes the edge from a to b. Of two
/// triangles on an edge, one gets the sign and the other its opposite. No component of the direction exceeds 1.
int line_side(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b);

/// All three on one line, or equal.
bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// Coordinates below 1e-60 m count as 0, so that no product here can underflow and lose its exactness.
Vec3 snapped(const Vec3& point);
std::vector<Vec3> snapped(std::span<const Vec3> points);

} // namespace raycontact
