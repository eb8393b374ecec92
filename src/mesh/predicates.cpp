// SPDX-License-Identifier: Apache-2.0
#include "mesh/predicates.h"

#include "mesh/vector.h"

#include <array>
#include <cmath>

namespace raycontact {
namespace {

/// A sum of doubles that do not overlap, by rising magnitude: the last one has the sign of the sum. Every operation is
/// `add`, which is exact for any summand (Shewchuk 1997, theorem 10); zeros are left out.
class Expansion {
public:
    Expansion() = default;
    Expansion(double a, double b) { // a - b
        add(a);
        add(-b);
    }

    void add(double summand) {
        double carry = summand;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const double part = parts_[i];
            const double sum = carry + part;
            const double shadow = sum - carry;
            const double error = (carry - (sum - shadow)) + (part - shadow);
            carry = sum;
            if (error != 0) parts_[kept++] = error;
        }
        if (carry != 0) parts_[kept++] = carry;
        size_ = kept;
    }

    /// Adds sign * a * b.
    void add_product(const Expansion& a, const Expansion& b, double sign) {
        for (std::size_t i = 0; i < a.size_; ++i) {
            for (std::size_t k = 0; k < b.size_; ++k) {
                const double factor = sign * a.parts_[i];
                const double product = factor * b.parts_[k];
                add(std::fma(factor, b.parts_[k], -product));
                add(product);
            }
        }
    }

    int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

private:
    // The largest is orient3d: 3 terms of 2 x (2 x 2 x 2 + 2 x 2 x 2) x 2 parts.
    std::array<double, 192> parts_;
    std::size_t size_ = 0;
};

constexpr double half_ulp = 1.1102230246251565e-16;
constexpr double bound3 = (7 + 56 * half_ulp) * half_ulp;
constexpr double bound2 = (3 + 16 * half_ulp) * half_ulp;

Expansion minor_of(const Expansion& a, const Expansion& b, const Expansion& c, const Expansion& d) {
    Expansion result; // a d - b c
    result.add_product(a, d, 1);
    result.add_product(b, c, -1);
    return result;
}

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    std::array<std::array<Expansion, 3>, 3> row;
    const std::array points{&a, &b, &c};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t k = 0; k < 3; ++k) row[r][k] = Expansion(axis(*points[r], k), axis(d, k));
    }
    Expansion sum;
    for (std::size_t r = 0; r < 3; ++r) {
        const std::array<Expansion, 3>&next = row[(r + 1) % 3], &last = row[(r + 2) % 3];
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
    return minor_of(Expansion(au, cu), Expansion(av, cv), Expansion(bu, cu), Expansion(bv, cv)).sign();
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
    return orient2d(a, b, c, 0) == 0 && orient2d(a, b, c, 1) == 0 && orient2d(a, b, c, 2) == 0;
}

Vec3 snapped(const Vec3& point) {
    const auto snap = [](double x) { return std::fabs(x) < 1e-60 ? 0 : x; };
    return {snap(point.x), snap(point.y), snap(point.z)};
}

} // namespace raycontact
