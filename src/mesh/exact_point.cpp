// SPDX-License-Identifier: Apache-2.0
#include "mesh/exact_point.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace raycontact {
namespace {

/// How far `rough` may be off along an axis, in metres, as a share of it; with a margin.
constexpr double roundings = 8e-16;

bool are_equal(const ExactPoint& p, const ExactPoint& q) {
    for (std::size_t k = 0; k < 3; ++k)
        if (order(p, q, k) != 0) return false;
    return true;
}

} // namespace

ExactPoint::ExactPoint(ExactVec3 scaled, Dyadic by) : at(std::move(scaled)), weight(std::move(by)) {
    rough = {ratio(at.x, weight), ratio(at.y, weight), ratio(at.z, weight)};
}

ExactPoint between(const ExactPoint& p, const ExactPoint& q, const Dyadic& to_p, const Dyadic& to_q) {
    const auto mean = [&](const Dyadic& a, const Dyadic& b) { return a * to_q + b * to_p; };
    return {{mean(p.at.x, q.at.x), mean(p.at.y, q.at.y), mean(p.at.z, q.at.z)}, mean(p.weight, q.weight)};
}

Dyadic area_of(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, std::size_t drop) {
    const std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
    const auto minor = [&](const ExactPoint& a, const ExactPoint& b) {
        return axis(a.at, u) * axis(b.at, v) - axis(a.at, v) * axis(b.at, u);
    };
    return minor(p, q) * r.weight + minor(q, r) * p.weight + minor(r, p) * q.weight;
}

std::optional<int> rough_turn(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, std::size_t drop) {
    const std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
    const auto size = [&](std::size_t k) {
        return std::max({std::fabs(axis(p.rough, k)), std::fabs(axis(q.rough, k)), std::fabs(axis(r.rough, k))});
    };
    const double eu = 4 * roundings * size(u), ev = 4 * roundings * size(v); // of differences
    const double qu = axis(q.rough, u) - axis(p.rough, u), qv = axis(q.rough, v) - axis(p.rough, v);
    const double ru = axis(r.rough, u) - axis(p.rough, u), rv = axis(r.rough, v) - axis(p.rough, v);
    const double turn = qu * rv - qv * ru;
    const double bound = eu * (std::fabs(rv) + std::fabs(qv)) + ev * (std::fabs(qu) + std::fabs(ru)) + 2 * eu * ev
                         + 4 * roundings * (std::fabs(qu * rv) + std::fabs(qv * ru));
    if (std::fabs(turn) > bound) return turn > 0 ? 1 : -1;
    return std::nullopt;
}

int order(const ExactPoint& p, const ExactPoint& q, std::size_t k) {
    const double a = axis(p.rough, k), b = axis(q.rough, k);
    if (std::fabs(a - b) > 4 * roundings * std::max(std::fabs(a), std::fabs(b))) return a < b ? -1 : 1;
    return (axis(p.at, k) * q.weight - axis(q.at, k) * p.weight).sign();
}

std::uint32_t PointTable::add(const ExactPoint& point) {
    const auto cell = [&](double x) { return std::floor(x / cell_) + 0.0; }; // + 0: no -0
    const Vec3& at = point.rough;
    for (const double x : {cell(at.x - slack_), cell(at.x + slack_)})
        for (const double y : {cell(at.y - slack_), cell(at.y + slack_)})
            for (const double z : {cell(at.z - slack_), cell(at.z + slack_)}) {
                const auto found = cells_.find({x, y, z});
                if (found == cells_.end()) continue;
                for (const std::uint32_t number : found->second)
                    if (are_equal(points_[number], point)) return number;
            }
    points_.push_back(point);
    const auto number = static_cast<std::uint32_t>(points_.size() - 1);
    cells_[{cell(at.x), cell(at.y), cell(at.z)}].push_back(number);
    return number;
}

} // namespace raycontact
