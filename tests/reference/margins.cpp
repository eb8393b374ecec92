// SPDX-License-Identifier: Apache-2.0
#include "reference/margins.h"

#include "reference/vector.h"

#include <algorithm>
#include <limits>

namespace raycontact::reference {

namespace {

double clamp(double x, double low, double high) {
    return x < low ? low : (x > high ? high : x);
}

// Squared distance between p + s d, s in [0, reach], d unit, and the segment from a to b (Ericson 2005, 5.1.9).
double ray_to_segment(const Vec3& p, const Vec3& d, double reach, const Vec3& a, const Vec3& b) {
    const Vec3 e = b - a;
    const Vec3 r = p - a;
    const double ee = dot(e, e);
    const double er = dot(e, r);
    const double dr = dot(d, r);
    const double de = dot(d, e);
    const double determinant = ee - de * de;
    double s = determinant > 1e-30 * ee ? clamp((de * er - dr * ee) / determinant, 0, reach) : 0;
    double t = (de * s + er) / ee;
    if (t < 0) {
        t = 0;
        s = clamp(-dr, 0, reach);
    } else if (t > 1) {
        t = 1;
        s = clamp(de - dr, 0, reach);
    }
    const Vec3 gap = (p + s * d) - (a + t * e);
    return dot(gap, gap);
}

} // namespace

// Ericson 2005, 5.1.5.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 ap = p - a;
    const double d1 = dot(ab, ap);
    const double d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bp = p - b;
    const double d3 = dot(ab, bp);
    const double d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
    const Vec3 cp = p - c;
    const double d5 = dot(ab, cp);
    const double d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
    const double scale = 1 / (va + vb + vc);
    return a + (vb * scale) * ab + (vc * scale) * ac;
}

double distance_to_edges(const Solid& solid, const Vec3& origin, const Vec3& direction, double reach,
                         std::uint32_t skip) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : solid.edges) {
        if (a == skip || b == skip) continue;
        least = std::min(least, ray_to_segment(origin, direction, reach, solid.vertices[a], solid.vertices[b]));
    }
    return std::sqrt(least);
}

double distance_to_surface(const Solid& solid, const Vec3& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& t : solid.triangles) {
        const Vec3 gap =
            point - closest_on_triangle(point, solid.vertices[t[0]], solid.vertices[t[1]], solid.vertices[t[2]]);
        least = std::min(least, dot(gap, gap));
    }
    return std::sqrt(least);
}

double distance_to_box(const Vec3& low, const Vec3& high, const Vec3& point) {
    double outside = 0;
    double inside = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double below = component(low, axis) - component(point, axis);
        const double above = component(point, axis) - component(high, axis);
        const double out = std::max({below, above, 0.0});
        outside += out * out;
        inside = std::min(inside, std::min(std::fabs(below), std::fabs(above)));
    }
    return outside > 0 ? std::sqrt(outside) : inside;
}

double Margins::least() const {
    return std::min({edge, t_max, surface, bounds});
}

const char* Margins::name_of_least() const {
    const double l = least();
    return l == edge ? "edge" : l == t_max ? "t_max" : l == surface ? "surface" : "bounds";
}

} // namespace raycontact::reference
