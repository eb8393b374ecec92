// SPDX-License-Identifier: Apache-2.0
#include "reference/ray.h"

#include "reference/vector.h"

#include <cmath>

namespace raycontact::reference {

namespace {

// a * b - c * d: its sign is exact. Rounding is monotonic, so unequal products are ordered as the exact ones are;
// where the rounded products agree, their errors decide.
inline double edge(double a, double b, double c, double d) {
    const double left = a * b;
    const double right = c * d;
    if (left != right) return left - right;
    return std::fma(a, b, -left) - std::fma(c, d, -right);
}

} // namespace

RayCaster::RayCaster(const Solid& solid)
    : solid_(solid), x_(solid.vertices.size()), y_(solid.vertices.size()), z_(solid.vertices.size()) {}

template <class Visit>
void RayCaster::each_hit(const Vec3& origin, const Vec3& direction, Visit visit) {
    const double size[3] = {std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)};
    const int kz = size[0] > size[1] ? (size[0] > size[2] ? 0 : 2) : (size[1] > size[2] ? 1 : 2);
    int kx = (kz + 1) % 3;
    int ky = (kx + 1) % 3;
    const double along = component(direction, kz);
    if (along < 0) std::swap(kx, ky); // keeps the winding
    const double shear_x = component(direction, kx) / along;
    const double shear_y = component(direction, ky) / along;
    for (std::size_t v = 0; v < x_.size(); ++v) {
        const Vec3 p = solid_.vertices[v] - origin;
        const double z = component(p, kz);
        x_[v] = component(p, kx) - shear_x * z;
        y_[v] = component(p, ky) - shear_y * z;
        z_[v] = z / along;
    }
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
        const auto [a, b, c] = solid_.triangles[t];
        const double u = edge(x_[b], y_[c], y_[b], x_[c]);
        const double v = edge(x_[c], y_[a], y_[c], x_[a]);
        if ((u < 0 && v > 0) || (u > 0 && v < 0)) continue;
        const double w = edge(x_[a], y_[b], y_[a], x_[b]);
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) continue;
        const double sum = u + v + w; // twice the signed area seen along the ray: positive when met from inside
        if (sum == 0) continue;       // edge-on: its neighbours decide
        const double distance = (u * z_[a] + v * z_[b] + w * z_[c]) / sum;
        if (distance >= 0) visit(t, distance, sum > 0);
    }
}

Hit RayCaster::closest(const Vec3& origin, const Vec3& direction) {
    Hit best;
    each_hit(origin, direction, [&](std::uint32_t triangle, double distance, bool from_inside) {
        if (distance < best.distance) best = {triangle, distance, from_inside};
    });
    return best;
}

Hit RayCaster::closest_from_inside(const Vec3& origin, const Vec3& direction, std::uint32_t skip) {
    Hit best;
    each_hit(origin, direction, [&](std::uint32_t triangle, double distance, bool from_inside) {
        const auto& corners = solid_.triangles[triangle];
        if (!from_inside || corners[0] == skip || corners[1] == skip || corners[2] == skip) return;
        if (distance < best.distance) best = {triangle, distance, true};
    });
    return best;
}

} // namespace raycontact::reference
