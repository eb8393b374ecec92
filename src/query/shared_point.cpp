// SPDX-License-Identifier: Apache-2.0
// Where two triangles meet, an edge of one meets the other (edges_meet()). Predicates say which and how; where along
// the edge is a quotient of exact volumes or areas, so that nearly parallel triangles are no special case.
#include "query/shared_point.h"

#include "mesh/triangle_pair.h"
#include "mesh/vector.h"

#include <optional>

namespace raycontact {

namespace {

using Placed = std::array<PlacedPoint, 3>;

Dyadic area(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, std::size_t drop) {
    return axis(area_normal(exact_place(a), exact_place(b), exact_place(c)), drop);
}

Dyadic height(const Placed& plane, const PlacedPoint& point) {
    const ExactVec3 corner = exact_place(plane[0]);
    return dot(area_normal(corner, exact_place(plane[1]), exact_place(plane[2])), exact_place(point) - corner);
}

/// On the way from p, which lies `from` high, to q, where the height is 0. Heights are not equal.
Vec3 between(const PlacedPoint& p, const PlacedPoint& q, const Dyadic& from, const Dyadic& to) {
    return p.rough + ratio(from, from - to) * (q.rough - p.rough);
}

// In a common plane, seen along `drop`: the edge p q, neither end of which lies in the triangle.
std::optional<Vec3> point_in_plane(const PlacedPoint& p, const PlacedPoint& q, const Placed& t, std::size_t drop) {
    for (std::size_t k = 0; k < 3; ++k) {
        const PlacedPoint &c = t[k], &d = t[(k + 1) % 3];
        if (!segments_meet(p, q, c, d, drop)) continue;
        const Dyadic from = area(p, q, c, drop), to = area(p, q, d, drop);
        return from.sign() == 0 ? c.rough : between(c, d, from, to); // on one line, both of its ends lie on p q
    }
    return std::nullopt;
}

std::optional<Vec3> point_of_edge(const PlacedPoint& p, const PlacedPoint& q, const Placed& t) {
    const int p_side = orient3d(t[0], t[1], t[2], p), q_side = orient3d(t[0], t[1], t[2], q);
    if (!segment_meets_triangle(p, q, p_side, q_side, t)) return std::nullopt;
    if (p_side != 0 || q_side != 0) return between(p, q, height(t, p), height(t, q));
    const std::size_t drop = drop_axis(t);
    if (point_in_triangle(p, t, drop)) return p.rough;
    if (point_in_triangle(q, t, drop)) return q.rough;
    return point_in_plane(p, q, t, drop);
}

} // namespace

Vec3 shared_point(const Placed& p, const Placed& q) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (const auto point = point_of_edge(p[k], p[(k + 1) % 3], q)) return *point;
        if (const auto point = point_of_edge(q[k], q[(k + 1) % 3], p)) return *point;
    }
    return p[0].rough; // of triangles that do not meet
}

} // namespace raycontact
