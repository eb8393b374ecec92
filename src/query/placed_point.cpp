// SPDX-License-Identifier: Apache-2.0
#include "query/placed_point.h"

#include "mesh/expansion.h"
#include "mesh/predicates.h"
#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact {

namespace {

// A coordinate: three products and two terms. A difference of two.
using Coordinate = Expansion<8>;
using Difference = Expansion<16>;
// Grown from parts that leave at least one bit between them (Shewchuk 1997, theorem 10), whose bits here lie between
// 2^-1040 and 2^110: no more than 575 parts.
using Determinant = Expansion<576>;

double snap(double x) {
    return std::fabs(x) < 1e-36 ? 0 : x;
}

// a + b = sum + rest, exactly (Knuth).
double rest_of_sum(double a, double b, double sum) {
    const double shadow = sum - a;
    return (a - (sum - shadow)) + (b - shadow);
}

Coordinate coordinate(const PlacedPoint& p, std::size_t k) {
    const Placing& at = *p.placing;
    Coordinate sum;
    for (std::size_t i = 0; i < 3; ++i)
        if (at.rotation[3 * k + i] != 0) sum.add_product(at.rotation[3 * k + i], axis(p.own, i));
    sum.add(axis(at.shift_rest, k));
    sum.add(axis(at.shift, k));
    return sum;
}

Difference difference(const Coordinate& a, const Coordinate& b) {
    Difference result;
    result.add(a, 1);
    result.add(b, -1);
    return result;
}

// The point in the world's axes, if doubles can hold it: the usual case of parts that are not turned.
bool exact_point(const PlacedPoint& p, Vec3& exact) {
    const Placing& at = *p.placing;
    if (!at.by_quarters || at.shift_rest != Vec3{}) return false;
    const Vec3 turned = rotated(at.rotation, p.own);
    exact = turned + at.shift;
    for (std::size_t k = 0; k < 3; ++k)
        if (rest_of_sum(axis(turned, k), axis(at.shift, k), axis(exact, k)) != 0) return false;
    return true;
}

template <std::size_t Count>
bool exact_points(const std::array<const PlacedPoint*, Count>& points, std::array<Vec3, Count>& exact) {
    for (std::size_t i = 0; i < Count; ++i)
        if (!exact_point(*points[i], exact[i])) return false;
    return true;
}

Determinant minor_of(const Difference& a, const Difference& b, const Difference& c, const Difference& d) {
    Determinant result; // a d - b c
    result.add_product(a, d, 1);
    result.add_product(b, c, -1);
    return result;
}

// Also of exact points, which are in the world's axes.
int orient3d_exact(const std::array<const PlacedPoint*, 4>& points) {
    std::array<Vec3, 4> exact;
    if (exact_points(points, exact)) return orient3d(exact[0], exact[1], exact[2], exact[3]);
    std::array<std::array<Difference, 3>, 3> row;
    for (std::size_t k = 0; k < 3; ++k) {
        const Coordinate last = coordinate(*points[3], k);
        for (std::size_t r = 0; r < 3; ++r) row[r][k] = difference(coordinate(*points[r], k), last);
    }
    Determinant sum;
    for (std::size_t r = 0; r < 3; ++r) {
        const auto &next = row[(r + 1) % 3], &last = row[(r + 2) % 3];
        if (row[r][2].size() > 0) sum.add_product(row[r][2], minor_of(next[0], next[1], last[0], last[1]), 1);
    }
    return sum.sign();
}

} // namespace

Placing::Placing(const std::array<double, 9>& turn, const Vec3& translation, const Vec3& origin) : rotation(turn) {
    for (double& x : rotation) {
        x = snap(x);
        by_quarters = by_quarters && (x == 0 || std::fabs(x) == 1);
    }
    const Vec3 from = own_point(translation), to = own_point(origin);
    const auto rest = [&](std::size_t k) { return rest_of_sum(axis(from, k), -axis(to, k), axis(shift, k)); };
    shift = from - to;
    shift_rest = {rest(0), rest(1), rest(2)};
}

ExactVec3 exact_place(const PlacedPoint& point) {
    const auto along = [&](std::size_t k) {
        const Placing& at = *point.placing;
        Dyadic sum = Dyadic(axis(at.shift, k)) + axis(at.shift_rest, k);
        for (std::size_t i = 0; i < 3; ++i) sum = sum + Dyadic(at.rotation[3 * k + i]) * axis(point.own, i);
        return sum;
    };
    return {along(0), along(1), along(2)};
}

Vec3 own_point(const Vec3& point) {
    return {snap(point.x), snap(point.y), snap(point.z)};
}

int orient3d(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, const PlacedPoint& d) {
    const Vec3 p = a.rough - d.rough, q = b.rough - d.rough, r = c.rough - d.rough;
    const double qr1 = q.x * r.y, qr2 = q.y * r.x, rp1 = r.x * p.y, rp2 = r.y * p.x, pq1 = p.x * q.y, pq2 = p.y * q.x;
    const double det = p.z * (qr1 - qr2) + q.z * (rp1 - rp2) + r.z * (pq1 - pq2);
    // Each of six products of three differences, none larger than `size`, is off by up to 2 errors in each factor. The
    // determinant's own rounding is below 1e-15 of those products (Shewchuk 1997).
    const double error = std::max({a.placing->error, b.placing->error, c.placing->error, d.placing->error});
    double size = 2 * error;
    for (const Vec3* v : {&p, &q, &r}) size = std::max({size, std::fabs(v->x), std::fabs(v->y), std::fabs(v->z)});
    const double permanent = std::fabs(p.z) * (std::fabs(qr1) + std::fabs(qr2))
                             + std::fabs(q.z) * (std::fabs(rp1) + std::fabs(rp2))
                             + std::fabs(r.z) * (std::fabs(pq1) + std::fabs(pq2));
    if (std::fabs(det) > 1e-15 * permanent + 160 * error * size * size) return det > 0 ? 1 : -1;
    return orient3d_exact({&a, &b, &c, &d});
}

int orient2d(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, std::size_t drop) {
    std::array<Vec3, 3> exact;
    if (exact_points<3>({&a, &b, &c}, exact)) return orient2d(exact[0], exact[1], exact[2], drop);
    const std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
    const Coordinate cu = coordinate(c, u), cv = coordinate(c, v);
    return minor_of(difference(coordinate(a, u), cu), difference(coordinate(a, v), cv),
                    difference(coordinate(b, u), cu), difference(coordinate(b, v), cv))
        .sign();
}

int order(const PlacedPoint& a, const PlacedPoint& b, std::size_t k) {
    return difference(coordinate(a, k), coordinate(b, k)).sign();
}

} // namespace raycontact
