// SPDX-License-Identifier: Apache-2.0
#include "query/nearest_feature.h"

#include "mesh/exact_vector.h"
#include "mesh/vector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace raycontact {

namespace {

constexpr double few_roundings = 1e-14, squared_roundings = few_roundings * few_roundings;

// The sign of (p - a) . (b - a): 1 where p is past a on the way to b.
int is_past(const Vec3& p, const Vec3& a, const Vec3& b) {
    if (p == a) return 0;
    const Vec3 off = p - a, along = b - a;
    const double value = dot(off, along);
    if (value * value > squared_roundings * dot(off, off) * dot(along, along)) return value > 0 ? 1 : -1;
    return dot(ExactVec3(p) - a, ExactVec3(b) - a).sign();
}

// -1 where p, seen along the normal of a, b, c, is beyond the edge from a to b; 0 where it is on it.
int is_within(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    if (p == a || p == b) return 0;
    const Vec3 off = p - a, along = b - a, other = c - a;
    const double value = dot(cross(along, other), cross(along, off)), size2 = dot(along, along);
    if (value * value > squared_roundings * size2 * size2 * dot(other, other) * dot(off, off))
        return value > 0 ? 1 : -1;
    const ExactVec3 exact = ExactVec3(b) - a;
    return dot(cross(exact, ExactVec3(c) - a), cross(exact, ExactVec3(p) - a)).sign();
}

bool has_area(const std::array<Vec3, 3>& t) {
    const Vec3 p = t[1] - t[0], q = t[2] - t[0], rough = cross(p, q);
    if (dot(rough, rough) > squared_roundings * dot(p, p) * dot(q, q)) return true;
    const ExactVec3 normal = area_normal(t[0], t[1], t[2]);
    return normal.x.sign() != 0 || normal.y.sign() != 0 || normal.z.sign() != 0;
}

} // namespace

/// Of the distance, without rounding: numerator / denominator, which is above 0.
struct NearestFeature::Squared {
    Dyadic numerator, denominator;
};

NearestFeature::NearestFeature(const Vec3& sought, const NumberedTriangle& triangle)
    : sought_(sought), triangle_(triangle) {
    const auto& t = triangle.corners;
    std::array<bool, 3> beyond{true, true, true};
    if (has_area(t)) {
        for (std::size_t k = 0; k < 3; ++k) beyond[k] = is_within(sought, t[k], t[(k + 1) % 3], t[(k + 2) % 3]) <= 0;
        if (!beyond[0] && !beyond[1] && !beyond[2]) {
            set_face();
            return;
        }
    }
    std::optional<NearestFeature> nearest;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!beyond[k]) continue;
        NearestFeature feature(*this);
        feature.set_nearest_of_edge(k);
        if (!nearest || feature.order(*nearest) < 0) nearest = feature;
    }
    *this = *nearest;
}

void NearestFeature::set_nearest_of_edge(std::size_t k) {
    const Vec3 &from = triangle_.corners[k], &to = triangle_.corners[(k + 1) % 3];
    if (is_past(sought_, from, to) <= 0)
        set_corner(k);
    else if (is_past(sought_, to, from) <= 0)
        set_corner((k + 1) % 3);
    else
        set_edge(k);
}

void NearestFeature::set_corner(std::size_t k) {
    kind_ = Kind::corner;
    std::swap(triangle_.corners[0], triangle_.corners[k]);
    std::swap(triangle_.vertices[0], triangle_.vertices[k]);
    point_ = triangle_.corners[0];
    away_ = sought_ - point_;
    distance_ = length(away_);
    error_ = few_roundings * distance_;
}

// The lower vertex first: so it is the same edge, and point, of both triangles there.
void NearestFeature::set_edge(std::size_t k) {
    kind_ = Kind::edge;
    std::rotate(triangle_.corners.begin(), triangle_.corners.begin() + static_cast<std::ptrdiff_t>(k),
                triangle_.corners.end());
    std::rotate(triangle_.vertices.begin(), triangle_.vertices.begin() + static_cast<std::ptrdiff_t>(k),
                triangle_.vertices.end());
    if (triangle_.vertices[1] < triangle_.vertices[0]) {
        std::swap(triangle_.corners[0], triangle_.corners[1]);
        std::swap(triangle_.vertices[0], triangle_.vertices[1]);
    }
    const Vec3 &from = triangle_.corners[0], off = sought_ - from, along = triangle_.corners[1] - from;
    const Vec3 part = (dot(off, along) / dot(along, along)) * along;
    point_ = from + part;
    away_ = off - part;
    distance_ = length(away_);
    error_ = few_roundings * length(off);
}

void NearestFeature::set_face() {
    kind_ = Kind::face;
    const auto& [a, b, c] = triangle_.corners;
    const Vec3 p = b - a, q = c - a, off = sought_ - a, normal = cross(p, q);
    const double size2 = dot(normal, normal), sizes = length(p) * length(q);
    constexpr double flattest = 0.01;
    if (size2 > flattest * flattest * sizes * sizes) {
        away_ = (dot(normal, off) / size2) * normal;
        error_ = few_roundings * length(off) * sizes / std::sqrt(size2);
    } else { // the normal of a needle is not accurate in double
        const ExactVec3 exact = area_normal(a, b, c);
        const Dyadic height = dot(exact, ExactVec3(sought_) - a), exact2 = dot(exact, exact);
        away_ = {ratio(exact.x * height, exact2), ratio(exact.y * height, exact2), ratio(exact.z * height, exact2)};
        error_ = few_roundings * length(away_);
    }
    point_ = a + (off - away_);
    distance_ = length(away_);
}

NearestFeature::Squared NearestFeature::squared() const {
    const auto& [a, b, c] = triangle_.corners;
    const ExactVec3 off = ExactVec3(sought_) - a;
    if (kind_ == Kind::corner) return {dot(off, off), 1};
    const ExactVec3 along = ExactVec3(b) - a;
    if (kind_ == Kind::edge) {
        const ExactVec3 beside = cross(along, off);
        return {dot(beside, beside), dot(along, along)};
    }
    const ExactVec3 normal = cross(along, ExactVec3(c) - a);
    const Dyadic height = dot(normal, off);
    return {height * height, dot(normal, normal)};
}

int NearestFeature::order(const NearestFeature& other) const {
    if (std::fabs(distance_ - other.distance_) > error_ + other.error_) return distance_ < other.distance_ ? -1 : 1;
    const auto &own = triangle_.vertices, &others = other.triangle_.vertices;
    const bool shared = kind_ == other.kind_ && own[0] == others[0] && (kind_ == Kind::corner || own[1] == others[1]);
    if (shared && kind_ != Kind::face) return 0;
    const Squared first = squared(), second = other.squared();
    return (first.numerator * second.denominator - second.numerator * first.denominator).sign();
}

} // namespace raycontact
