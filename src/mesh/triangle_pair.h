// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/predicates.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace raycontact {

// Whether two triangles meet, decided by the predicates of their points: orient3d(), orient2d() and order().

/// An axis along which the triangle does not look like a line.
template <class Point>
std::size_t drop_axis(const std::array<Point, 3>& t) {
    for (std::size_t k = 0; k < 2; ++k) {
        if (orient2d(t[0], t[1], t[2], k) != 0) return k;
    }
    return 2;
}

// In a common plane, seen along `drop`. Segments are closed.
template <class Point>
bool segments_meet(const Point& a, const Point& b, const Point& c, const Point& d, std::size_t drop) {
    const int c_side = orient2d(a, b, c, drop), d_side = orient2d(a, b, d, drop);
    if (c_side * d_side > 0) return false;
    const int a_side = orient2d(c, d, a, drop), b_side = orient2d(c, d, b, drop);
    if (a_side * b_side > 0) return false;
    if (c_side != 0 || d_side != 0 || a_side != 0 || b_side != 0) return true;
    // All on one line: their extents must overlap along both remaining axes.
    for (const std::size_t k : {(drop + 1) % 3, (drop + 2) % 3}) {
        const std::array orders{order(a, c, k), order(a, d, k), order(b, c, k), order(b, d, k)};
        if (std::ranges::all_of(orders, [](int o) { return o < 0; })) return false;
        if (std::ranges::all_of(orders, [](int o) { return o > 0; })) return false;
    }
    return true;
}

template <class Point>
bool point_in_triangle(const Point& p, const std::array<Point, 3>& t, std::size_t drop) {
    const int s0 = orient2d(t[0], t[1], p, drop), s1 = orient2d(t[1], t[2], p, drop),
              s2 = orient2d(t[2], t[0], p, drop);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// Closed segment p q against closed triangle t; the sides of p and q of its plane are known.
template <class Point>
bool segment_meets_triangle(const Point& p, const Point& q, int p_side, int q_side, const std::array<Point, 3>& t) {
    if (p_side * q_side > 0) return false;
    if (p_side == 0 && q_side == 0) {
        const std::size_t drop = drop_axis(t);
        return point_in_triangle(p, t, drop) || segments_meet(p, q, t[0], t[1], drop)
               || segments_meet(p, q, t[1], t[2], drop) || segments_meet(p, q, t[2], t[0], drop);
    }
    // The line crosses the plane in one point, on the segment; it passes the edges all on the same side, or touches
    // them.
    const int s0 = orient3d(p, q, t[0], t[1]), s1 = orient3d(p, q, t[1], t[2]), s2 = orient3d(p, q, t[2], t[0]);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// Closed triangles that share no corner (`shared` 0), or their corner 0 (1). If they meet, an edge of one meets the
/// other: the common segment ends on an edge; if they are coplanar, the boundaries cross or one contains the other.
/// What they have in common besides corner 0 is convex with it, so it reaches an opposite edge.
template <class Point>
bool edges_meet(const std::array<Point, 3>& a, const std::array<Point, 3>& b, std::size_t shared) {
    const auto one_side = [&](const std::array<int, 3>& side) {
        return side[1] == side[2] && side[2] != 0 && (shared == 1 || side[0] == side[1]);
    };
    std::array<int, 3> side_a{}, side_b{};
    for (std::size_t i = shared; i < 3; ++i) side_a[i] = orient3d(b[0], b[1], b[2], a[i]);
    if (one_side(side_a)) return false;
    for (std::size_t i = shared; i < 3; ++i) side_b[i] = orient3d(a[0], a[1], a[2], b[i]);
    if (one_side(side_b)) return false;
    for (std::size_t i = shared; i < 3 - shared; ++i) {
        const std::size_t k = (i + 1) % 3;
        if (segment_meets_triangle(a[i], a[k], side_a[i], side_a[k], b)) return true;
        if (segment_meets_triangle(b[i], b[k], side_b[i], side_b[k], a)) return true;
    }
    return false;
}

/// Whether two triangles of different meshes have a point in common. As exact as the predicates; neither may be
/// degenerate.
template <class Point>
bool triangles_meet(const std::array<Point, 3>& a, const std::array<Point, 3>& b) {
    return edges_meet(a, b, 0);
}

} // namespace raycontact
