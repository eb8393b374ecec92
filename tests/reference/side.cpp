// SPDX-License-Identifier: Apache-2.0
#include "reference/side.h"

#include "reference/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::reference {

namespace {

constexpr std::uint32_t cells = 64; ///< each way

std::uint32_t cell_of(double x, double low, double per_metre) {
    const double cell = (x - low) * per_metre;
    return cell <= 0 ? 0 : std::min(static_cast<std::uint32_t>(std::min(cell, 1e6)), cells - 1);
}

} // namespace

double winding_number(const Solid& solid, const Vec3& point) {
    double angle = 0;
    for (const auto& t : solid.triangles) {
        const Vec3 a = solid.vertices[t[0]] - point;
        const Vec3 b = solid.vertices[t[1]] - point;
        const Vec3 c = solid.vertices[t[2]] - point;
        const double la = length(a);
        const double lb = length(b);
        const double lc = length(c);
        angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return angle / (4 * std::numbers::pi);
}

SideIndex::SideIndex(const Solid& solid) : solid_(solid) {
    for (int axis = 0; axis < 3; ++axis) axes_[static_cast<std::size_t>(axis)] = make_axis(axis);
}

SideIndex::Axis SideIndex::make_axis(int axis) const {
    const int ku = (axis + 1) % 3;
    const int kv = (axis + 2) % 3;
    Axis index;
    index.low_u = component(solid_.box_min, ku);
    index.low_v = component(solid_.box_min, kv);
    index.per_u = cells / (component(solid_.box_max, ku) - index.low_u);
    index.per_v = cells / (component(solid_.box_max, kv) - index.low_v);
    std::vector<std::vector<std::uint32_t>> lists(cells * cells);
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
        const auto& corners = solid_.triangles[t];
        const auto range = [&](int k, double low, double per) {
            const double pa = component(solid_.vertices[corners[0]], k);
            const double pb = component(solid_.vertices[corners[1]], k);
            const double pc = component(solid_.vertices[corners[2]], k);
            const double slack = 1e-9 * solid_.diagonal;
            return std::array{cell_of(std::min({pa, pb, pc}) - slack, low, per),
                              cell_of(std::max({pa, pb, pc}) + slack, low, per)};
        };
        const auto us = range(ku, index.low_u, index.per_u);
        const auto vs = range(kv, index.low_v, index.per_v);
        for (std::uint32_t v = vs[0]; v <= vs[1]; ++v)
            for (std::uint32_t u = us[0]; u <= us[1]; ++u) lists[v * cells + u].push_back(t);
    }
    for (const auto& list : lists) {
        index.first.push_back(static_cast<std::uint32_t>(index.triangles.size()));
        index.triangles.insert(index.triangles.end(), list.begin(), list.end());
    }
    index.first.push_back(static_cast<std::uint32_t>(index.triangles.size()));
    return index;
}

SideIndex::Side SideIndex::side_along(int axis, const Vec3& point) const {
    const int ku = (axis + 1) % 3;
    const int kv = (axis + 2) % 3;
    const Axis& index = axes_[static_cast<std::size_t>(axis)];
    const double pu = component(point, ku);
    const double pv = component(point, kv);
    const double pw = component(point, axis);
    const std::uint32_t cell = cell_of(pv, index.low_v, index.per_v) * cells + cell_of(pu, index.low_u, index.per_u);
    const double tiny =
        1e-12 * solid_.diagonal * solid_.diagonal; // twice the area of a sliver nobody can tell from zero
    int crossings = 0;
    for (std::uint32_t k = index.first[cell]; k < index.first[cell + 1]; ++k) {
        const auto& t = solid_.triangles[index.triangles[k]];
        double u[3];
        double v[3];
        double w[3];
        for (std::size_t c = 0; c < 3; ++c) {
            u[c] = component(solid_.vertices[t[c]], ku) - pu;
            v[c] = component(solid_.vertices[t[c]], kv) - pv;
            w[c] = component(solid_.vertices[t[c]], axis) - pw;
        }
        const double ea = u[1] * v[2] - v[1] * u[2];
        const double eb = u[2] * v[0] - v[2] * u[0];
        const double ec = u[0] * v[1] - v[0] * u[1];
        if ((ea < -tiny || eb < -tiny || ec < -tiny) && (ea > tiny || eb > tiny || ec > tiny)) continue; // clear miss
        if (w[0] < 0 && w[1] < 0 && w[2] < 0) continue;                                                  // behind
        const bool clear = (ea > tiny && eb > tiny && ec > tiny) || (ea < -tiny && eb < -tiny && ec < -tiny);
        if (!clear) return Side::unsure;
        const double height = (ea * w[0] + eb * w[1] + ec * w[2]) / (ea + eb + ec);
        if (std::fabs(height) < 1e-9 * solid_.diagonal) return Side::unsure;
        if (height > 0) crossings += ea > 0 ? 1 : -1; // leaving counts one, entering takes one away
    }
    return crossings == 0 ? Side::outside : Side::inside;
}

SideIndex::Side SideIndex::side(const Vec3& point) const {
    for (int axis = 0; axis < 3; ++axis) {
        const Side answer = side_along(axis, point);
        if (answer != Side::unsure) return answer;
    }
    return Side::unsure;
}

} // namespace raycontact::reference
