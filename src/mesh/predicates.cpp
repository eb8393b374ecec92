// SPDX-License-Identifier: Apache-2.0
#include "mesh/predicates.h"

#include "mesh/expansion.h"
#include "mesh/vector.h"

#include <array>
#include <cmath>

namespace raycontact {
namespace {

// The largest is orient3d: 3 terms of 2 x (2 x 2 x 2 + 2 x 2 x 2) x 2 parts.
using Sum = Expansion<192>;

constexpr double half_ulp = 1.1102230246251565e-16;
constexpr double bound3 = (7 + 56 * half_ulp) * half_ulp;
constexpr double bound2 = (3 + 16 * half_ulp) * half_ulp;

Sum minor_of(const Sum& a, const Sum& b, const Sum& c, const Sum& d) {
    Sum result; // a d - b c
    result.add_product(a, d, 1);
    result.add_product(b, c, -1);
    return result;
}

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    std::array<std::array<Sum, 3>, 3> row;
    const std::array points{&a, &b, &c};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t k = 0; k < 3; ++k) row[r][k] = Sum(axis(*points[r], k), axis(d, k));
    }
    Sum sum;
    for (std::size_t r = 0; r < 3; ++r) {
        const std::array<Sum, 3>&next = row[(r + 1) % 3], &last = row[(r + 2) % 3];
        sum.add_product(row[r][2], minor_of(next[0], next[1], last[0], last[1]), 1);
    }
    return sum.sign();
}

} // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 p = a - d, q = b - d, r = c - d;
    const double qr1 = q.x * r.y, qr2 = q.y * r.x, rp1 = r.x * p.y, rp2 = r.y * p.x, pq1 = p.x * q.y, pq2 = p.y * q.x;
    const double det = p.z * (qr1 - qr2) + q.z * (rp1 - rp2) + r.z * (pq1 - pq2);
    const double permanent = std::fabs(p.z) * (std::fabs(qr1) + std::fabs(qr2))
                             + std::fabs(q.z) * (std::fabs(rp1) + std::fabs(rp2))
                             + std::fabs(r.z) * (std::fabs(pq1) + std::fabs(pq2));
    if (std::fabs(det) > bound3 * permanent) return det > 0 ? 1 : -1;
    // A computed difference is 0 only where the exact one is: faces in a plane across an axis end here.
    if (permanent == 0) return 0;
    return orient3d_exact(a, b, c, d);
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t drop) {
    const std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
    const double au = axis(a, u), av = axis(a, v), bu = axis(b, u), bv = axis(b, v), cu = axis(c, u), cv = axis(c, v);
    const double left = (au - cu) * (bv - cv), right = (av - cv) * (bu - cu);
    const double det = left - right, permanent = std::fabs(left) + std::fabs(right);
    if (std::fabs(det) > bound2 * permanent) return det > 0 ? 1 : -1;
    if (permanent == 0) return 0;
    return minor_of(Sum(au, cu), Sum(av, cv), Sum(bu, cu), Sum(bv, cv)).sign();
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
    return orient2d(a, b, c, 0) == 0 && orient2d(a, b, c, 1) == 0 && orient2d(a, b, c, 2) == 0;
}

int order(const Vec3& a, const Vec3& b, std::size_t k) {
    return axis(a, k) < axis(b, k) ? -1 : axis(a, k) > axis(b, k) ? 1 : 0;
}

int line_side(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b) {
    const Vec3 p = a - origin, q = b - origin, &d = direction;
    const double xy1 = p.x * q.y, xy2 = p.y * q.x, yz1 = p.y * q.z, yz2 = p.z * q.y, zx1 = p.z * q.x, zx2 = p.x * q.z;
    const double det = d.z * (xy1 - xy2) + d.x * (yz1 - yz2) + d.y * (zx1 - zx2);
    const double permanent = std::fabs(d.z) * (std::fabs(xy1) + std::fabs(xy2))
                             + std::fabs(d.x) * (std::fabs(yz1) + std::fabs(yz2))
                             + std::fabs(d.y) * (std::fabs(zx1) + std::fabs(zx2));
    if (std::fabs(det) > bound3 * permanent) return det > 0 ? 1 : -1;
    if (permanent == 0) return 0;
    Sum sum;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
        Sum along;
        along.add(axis(direction, k));
        sum.add_product(along,
                        minor_of(Sum(axis(a, u), axis(origin, u)), Sum(axis(a, v), axis(origin, v)),
                                 Sum(axis(b, u), axis(origin, u)), Sum(axis(b, v), axis(origin, v))),
                        1);
    }
    return sum.sign();
}

Vec3 snapped(const Vec3& point) {
    const auto snap = [](double x) { return std::fabs(x) < 1e-60 ? 0 : x; };
    return {snap(point.x), snap(point.y), snap(point.z)};
}

std::vector<Vec3> snapped(std::span<const Vec3> points) {
    std::vector<Vec3> exact;
    exact.reserve(points.size());
    for (const Vec3& p : points) exact.push_back(snapped(p));
    return exact;
}

} // namespace raycontact
