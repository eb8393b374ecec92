// SPDX-License-Identifier: Apache-2.0
#include "round/facets.h"
#include "mesh/vector.h"

#include <raycontact/query.h>

#include <algorithm>

namespace raycontact {

void add_facet(const std::array<Vec3, 3>& corner, std::uint32_t triangle, const std::array<int, 2>& name,
               std::vector<Facet>& out) {
    Facet f{corner, cross(corner[1] - corner[0], corner[2] - corner[0]), corner[0], corner[0], triangle, name};
    const double area = length(f.normal);
    if (!(area > 0)) return;
    f.normal = (1 / area) * f.normal;
    for (const Vec3& c : corner) {
        f.low = least(f.low, c);
        f.high = most(f.high, c);
    }
    out.push_back(f);
}

// Ericson, Real-Time Collision Detection (2005), 5.1.5.
Nearest nearest(const Facet& facet, const Vec3& p) {
    const auto& [a, b, c] = facet.corner;
    const auto at = [&](const Vec3& q, unsigned on) { return Nearest{q, length2(p - q), on}; };
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double ab_ap = dot(ab, ap), ac_ap = dot(ac, ap), ab_bp = dot(ab, bp), ac_bp = dot(ac, bp),
                 ab_cp = dot(ab, cp), ac_cp = dot(ac, cp);
    if (ab_ap <= 0 && ac_ap <= 0) return at(a, 1);
    if (ab_bp >= 0 && ac_bp <= ab_bp) return at(b, 2);
    if (ac_cp >= 0 && ab_cp <= ac_cp) return at(c, 4);
    const double of_c = ab_ap * ac_bp - ab_bp * ac_ap, of_b = ab_cp * ac_ap - ab_ap * ac_cp,
                 of_a = ab_bp * ac_cp - ab_cp * ac_bp;
    if (of_c <= 0 && ab_ap >= 0 && ab_bp <= 0) return at(a + (ab_ap / (ab_ap - ab_bp)) * ab, 3);
    if (of_b <= 0 && ac_ap >= 0 && ac_cp <= 0) return at(a + (ac_ap / (ac_ap - ac_cp)) * ac, 5);
    if (of_a <= 0 && ac_bp >= ab_bp && ab_cp >= ac_cp)
        return at(b + ((ac_bp - ab_bp) / (ac_bp - ab_bp + ab_cp - ac_cp)) * (c - b), 6);
    // Along the normal: the sum of three corners would round by the length of a thin triangle.
    return at(p - dot(ap, facet.normal) * facet.normal, 7);
}

double least_away(const Facet& facet, const Vec3& a, const Vec3& b) {
    const Vec3 middle = 0.5 * (facet.low + facet.high), along = b - a;
    const double square = length2(along);
    const double at = square > 0 ? std::clamp(dot(middle - a, along) / square, 0.0, 1.0) : 0;
    return length(middle - (a + at * along)) - length(facet.high - middle);
}

void Facets::near(const Vec3& low, const Vec3& high, std::vector<Facet>& out) const {
    if (source_) return source_->near(low, high, out);
    static thread_local std::vector<std::uint32_t> triangles;
    triangles_in_box(*shape_, low, high, triangles);
    for (const std::uint32_t t : triangles) {
        const auto& ids = shape_->triangles()[t];
        add_facet({shape_->vertices()[ids[0]], shape_->vertices()[ids[1]], shape_->vertices()[ids[2]]}, t, {-1, -1},
                  out);
    }
}

double Facets::size() const {
    return source_ ? source_->size() : shape_->radius();
}

} // namespace raycontact
