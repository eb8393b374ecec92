// SPDX-License-Identifier: Apache-2.0
#include "unit/query/brute_force.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace raycontact::brute {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec3 along(const Vec3& from, double t, const Vec3& way) {
    return {from.x + t * way.x, from.y + t * way.y, from.z + t * way.z};
}
double norm(const Vec3& a) {
    return std::sqrt(dot(a, a));
}

// A convex function of the place on the first segment: of each the nearest on the other, by golden section.
double distance(const Vec3& a, const Vec3& a_end, const Vec3& b, const Vec3& b_end) {
    const Vec3 u = minus(a_end, a), v = minus(b_end, b);
    const auto from = [&](double s) {
        const Vec3 p = along(a, s, u);
        const double t = std::clamp(dot(minus(p, b), v) / dot(v, v), 0.0, 1.0);
        return norm(minus(p, along(b, t, v)));
    };
    double low = 0, high = 1;
    const double part = (std::sqrt(5.0) - 1) / 2;
    double s = high - part * (high - low), t = low + part * (high - low);
    double at_s = from(s), at_t = from(t);
    for (int i = 0; i < 36; ++i) {
        if (at_s < at_t) {
            high = t;
            t = s;
            at_t = at_s;
            s = high - part * (high - low);
            at_s = from(s);
        } else {
            low = s;
            s = t;
            at_s = at_t;
            t = low + part * (high - low);
            at_t = from(t);
        }
    }
    return std::min({at_s, at_t, from(0), from(1)});
}

// Moeller and Trumbore 1997; along the direction, in its lengths.
std::optional<double> meet(const Vec3& origin, const Vec3& direction, const Triangle& t) {
    const Vec3 e = minus(t[1], t[0]), f = minus(t[2], t[0]), h = cross(direction, f);
    const double determinant = dot(e, h);
    if (determinant == 0) return std::nullopt;
    const Vec3 s = minus(origin, t[0]), q = cross(s, e);
    const double u = dot(s, h) / determinant, v = dot(direction, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
    return dot(f, q) / determinant;
}

bool crosses(const Triangle& a, const Triangle& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        const auto at = meet(a[k], minus(a[(k + 1) % 3], a[k]), b);
        if (at && *at >= 0 && *at <= 1) return true;
    }
    return false;
}

} // namespace

std::vector<Triangle> placed(const Mesh& mesh, const Pose& pose) {
    std::vector<Triangle> triangles;
    for (const auto& t : mesh.triangles) {
        Triangle corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = transform_point(pose, mesh.vertices[t[k]]);
        triangles.push_back(corners);
    }
    return triangles;
}

double size_of(const std::vector<Triangle>& mesh) {
    Vec3 low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};
    for (const Triangle& t : mesh)
        for (const Vec3& p : t) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
    return norm(minus(high, low));
}

// By the sides of its plane and of its edges.
double distance(const Vec3& point, const Triangle& t) {
    const Vec3 n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    bool within = true;
    double nearest = infinite;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = minus(t[(k + 1) % 3], t[k]), off = minus(point, t[k]);
        within = within && dot(cross(edge, off), n) >= 0;
        const double part = std::clamp(dot(off, edge) / dot(edge, edge), 0.0, 1.0);
        nearest = std::min(nearest, norm(minus(point, along(t[k], part, edge))));
    }
    return within ? std::fabs(dot(minus(point, t[0]), n)) / norm(n) : nearest;
}

double distance(const Triangle& a, const Triangle& b, double most) {
    if (crosses(a, b) || crosses(b, a)) return 0;
    double nearest = most;
    for (std::size_t k = 0; k < 3; ++k) {
        nearest = std::min({nearest, distance(a[k], b), distance(b[k], a)});
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 &p = a[k], &p_end = a[(k + 1) % 3], &q = b[i], &q_end = b[(i + 1) % 3];
            // Most edges are farther from each other than a corner from the other triangle.
            if (norm(minus(p, q)) - norm(minus(p_end, p)) - norm(minus(q_end, q)) >= nearest) continue;
            nearest = std::min(nearest, distance(p, p_end, q, q_end));
        }
    }
    return nearest;
}

double distance(const Vec3& point, const std::vector<Triangle>& mesh) {
    double nearest = infinite;
    for (const Triangle& t : mesh) nearest = std::min(nearest, distance(point, t));
    return nearest;
}

double distance(const std::vector<Triangle>& a, bool a_is_closed, const std::vector<Triangle>& b, bool b_is_closed) {
    if ((b_is_closed && std::fabs(winding(b, a[0][0])) > 0.5) || (a_is_closed && std::fabs(winding(a, b[0][0])) > 0.5))
        return 0;
    double nearest = infinite;
    for (const Triangle& s : a)
        for (const Triangle& t : b) {
            // Balls about the corners are farther apart than the best so far: most pairs.
            const double reach_s = std::max(norm(minus(s[1], s[0])), norm(minus(s[2], s[0])));
            const double reach_t = std::max(norm(minus(t[1], t[0])), norm(minus(t[2], t[0])));
            if (norm(minus(s[0], t[0])) - reach_s - reach_t < nearest) nearest = distance(s, t, nearest);
        }
    return nearest;
}

std::optional<Hit> raycast(const std::vector<Triangle>& mesh, const Vec3& origin, const Vec3& direction) {
    std::optional<Hit> nearest;
    for (std::size_t i = 0; i < mesh.size(); ++i) {
        const auto at = meet(origin, direction, mesh[i]);
        if (at && *at >= 0 && (!nearest || *at < nearest->distance)) nearest = Hit{i, *at};
    }
    return nearest;
}

// Solid angles (van Oosterom and Strackee 1983).
double winding(const std::vector<Triangle>& mesh, const Vec3& point) {
    double angles = 0;
    for (const Triangle& t : mesh) {
        const Vec3 a = minus(t[0], point), b = minus(t[1], point), c = minus(t[2], point);
        const double la = norm(a), lb = norm(b), lc = norm(c);
        angles += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return angles / (4 * std::numbers::pi);
}

} // namespace raycontact::brute
