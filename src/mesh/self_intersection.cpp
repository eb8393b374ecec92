// SPDX-License-Identifier: Apache-2.0
#include "mesh/self_intersection.h"

#include "mesh/predicates.h"
#include "mesh/triangle_pair.h"

#include <algorithm>

namespace raycontact {
namespace {

using Corners = std::array<Vec3, 3>;

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

} // namespace raycontact
