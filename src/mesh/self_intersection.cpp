// SPDX-License-Identifier: Apache-2.0
#include "mesh/self_intersection.h"

#include "mesh/predicates.h"

#include <algorithm>

namespace raycontact {
namespace {

using Corners = std::array<Vec3, 3>;

/// An axis along which the triangle does not look like a line.
std::size_t drop_axis(const Corners& t) {
    for (std::size_t k = 0; k < 2; ++k) {
        if (orient2d(t[0], t[1], t[2], k) != 0) return k;
    }
    return 2;
}

// In a common plane, seen along `drop`. Segments are closed.
bool segments_meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::size_t drop) {
    const int c_side = orient2d(a, b, c, drop), d_side = orient2d(a, b, d, drop);
    if (c_side * d_side > 0) return false;
    const int a_side = orient2d(c, d, a, drop), b_side = orient2d(c, d, b, drop);
    if (a_side * b_side > 0) return false;
    if (c_side != 0 || d_side != 0 || a_side != 0 || b_side != 0) return true;
    // All on one line: their extents must overlap along both remaining axes.
    for (const std::size_t k : {(drop + 1) % 3, (drop + 2) % 3}) {
        const auto [low1, high1] = std::minmax({axis(a, k), axis(b, k)});
        const auto [low2, high2] = std::minmax({axis(c, k), axis(d, k)});
        if (high1 < low2 || high2 < low1) return false;
    }
    return true;
}

bool point_in_triangle(const Vec3& p, const Corners& t, std::size_t drop) {
    const int s0 = orient2d(t[0], t[1], p, drop), s1 = orient2d(t[1], t[2], p, drop),
              s2 = orient2d(t[2], t[0], p, drop);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// Closed segment p q against closed triangle t; the sides of p and q of its plane are known.
bool segment_meets_triangle(const Vec3& p, const Vec3& q, int p_side, int q_side, const Corners& t) {
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
bool edges_meet(const Corners& a, const Corners& b, std::size_t shared) {
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

/// A plane through the shared corner with one triangle on either side, clear of rounding: the common case, for four dot
/// products instead of exact determinants on nearly flat surfaces.
bool clearly_apart(const Corners& a, const Corners& b) {
    const Vec3 a1 = a[1] - a[0], a2 = a[2] - a[0], b1 = b[1] - b[0], b2 = b[2] - b[0];
    const Vec3 normal = (a1 + a2) - (b1 + b2);
    const auto magnitude = [](const Vec3& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); };
    const double most = std::max({magnitude(a1), magnitude(a2), magnitude(b1), magnitude(b2)});
    const double error = 1e-14 * magnitude(normal) * most;
    return dot(normal, a1) > error && dot(normal, a2) > error && dot(normal, b1) < -error && dot(normal, b2) < -error;
}

/// a and b share corners 0 and 1: they overlap only when folded flat onto one another.
bool folded_flat(const Corners& a, const Corners& b) {
    if (orient3d(a[0], a[1], a[2], b[2]) != 0) return false;
    const std::size_t drop = drop_axis(a);
    return orient2d(a[0], a[1], a[2], drop) == orient2d(a[0], a[1], b[2], drop);
}

/// The dihedral angle is clearly above 90 degrees.
bool clearly_open(const Corners& a, const Corners& b) {
    const Vec3 edge = a[1] - a[0];
    const Vec3 m = cross(edge, a[2] - a[0]), n = cross(edge, b[2] - a[0]);
    const double scale = length(edge);
    const double error = 1e-13 * scale * scale * length(a[2] - a[0]) * length(b[2] - a[0]);
    return dot(m, n) < -error;
}

} // namespace

bool triangles_meet(std::span<const Vec3> vertices, const Triangle& a, const Triangle& b) {
    // Shared corners are turned to the front of both.
    Triangle p = a, q = b;
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto same = std::find(q.begin() + shared, q.end(), p[i]);
        if (same == q.end()) continue;
        std::swap(*same, q[shared]);
        std::swap(p[i], p[shared]);
        ++shared;
    }
    Corners u, v;
    for (std::size_t i = 0; i < 3; ++i) {
        u[i] = vertices[p[i]];
        v[i] = vertices[q[i]];
    }
    if (shared == 0) return edges_meet(u, v, 0);
    if (shared == 1) return !clearly_apart(u, v) && edges_meet(u, v, 1);
    return shared == 3 || (!clearly_open(u, v) && folded_flat(u, v));
}

bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    return edges_meet(a, b, 0);
}

} // namespace raycontact
