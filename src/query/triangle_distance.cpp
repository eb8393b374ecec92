// SPDX-License-Identifier: Apache-2.0
#include "query/triangle_distance.h"

#include <algorithm>

namespace raycontact {

namespace {

// The closest points of two segments (after Ericson 2005, section 5.1.9). Of nearly parallel ones rounding may put the
// place anywhere along both.
void shorten_between_edges(Span& span, const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& v) {
    const auto ratio = [](double above, double below) { return below > 0 ? std::clamp(above / below, 0.0, 1.0) : 0; };
    const Vec3 w = p - q;
    const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
    const double s = ratio(uv * vw - vv * uw, uu * vv - uv * uv);
    const double t = ratio(uv * s + vw, vv);
    span.shorten(p + ratio(uv * t - uw, uu) * u, q + t * v);
}

// Seen along its normal.
bool is_before(const Face& face, const Vec3& p) {
    for (std::size_t k = 0; k < 3; ++k)
        if (dot(face.normal, cross(face.edge[k], p - face.corner[k])) < 0) return false;
    return true;
}

// The point within the face that is closest to p, unless an edge is closer or it is no nearer than `least`, m^2.
std::optional<Vec3> within(const Face& face, const Vec3& p, double least) {
    const Vec3 off = p - face.corner[0];
    const double height = dot(face.normal, off), size2 = dot(face.normal, face.normal);
    if (!(height * height < least * size2) || !is_before(face, p)) return std::nullopt;
    return p - (height / size2) * face.normal;
}

} // namespace

Face::Face(const Corners& t) : corner(t), edge{t[1] - t[0], t[2] - t[1], t[0] - t[2]} {
    const Vec3 n = cross(edge[0], edge[1]);
    if (dot(n, n) > 1e-12 * dot(edge[0], edge[0]) * dot(edge[1], edge[1])) normal = n;
}

void shorten_between(Span& span, const Face& p, const Face& q) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) shorten_between_edges(span, p.corner[i], p.edge[i], q.corner[k], q.edge[k]);
    for (const Vec3& corner : p.corner)
        if (const auto point = within(q, corner, span.squared)) span.shorten(corner, *point);
    for (const Vec3& corner : q.corner)
        if (const auto point = within(p, corner, span.squared)) span.shorten(*point, corner);
}

std::optional<Vec3> crossing_of(const Face& segment, const Face& face) {
    const Vec3 &p = segment.corner[0], &way = segment.edge[0], normal = cross(face.edge[0], face.edge[1]);
    if (!(dot(normal, p - face.corner[0]) * dot(normal, segment.corner[1] - face.corner[0]) < 0)) return std::nullopt;
    // By volumes over the edges, not by Face::normal, which a needle has not.
    Vec3 point;
    std::array<double, 3> volumes{};
    for (std::size_t k = 0; k < 3; ++k) {
        volumes[k] = dot(way, cross(face.corner[(k + 1) % 3] - p, face.corner[(k + 2) % 3] - p));
        point += volumes[k] * face.corner[k];
    }
    const double sum = volumes[0] + volumes[1] + volumes[2];
    if (std::ranges::any_of(volumes, [&](double volume) { return volume * sum < 0; }) || sum == 0) return std::nullopt;
    return point / sum;
}

} // namespace raycontact
