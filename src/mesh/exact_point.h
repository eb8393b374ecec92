// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/exact_vector.h"
#include "mesh/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace raycontact {

/// A point of rational coordinates, as those where triangles cross: at / weight, which is above 0.
struct ExactPoint {
    ExactVec3 at;
    Dyadic weight{1};
    Vec3 rough; ///< the same, right to some 1e-15 of itself

    ExactPoint() = default;
    explicit ExactPoint(const Vec3& point) : at(point), rough(point) {}
    ExactPoint(ExactVec3 scaled, Dyadic by);
};

/// The point of the line from p to q that is as far from either as `to_p` and `to_q` say, each times the weight of its
/// point; both at least 0 and not both 0.
ExactPoint between(const ExactPoint& p, const ExactPoint& q, const Dyadic& to_p, const Dyadic& to_q);

/// Of p, q, r seen along coordinate axis `drop`, times their weights: above 0 where they turn left.
Dyadic area_of(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, std::size_t drop);
/// The sign of that, where doubles are enough to tell.
std::optional<int> rough_turn(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, std::size_t drop);
/// Of p and q along an axis: -1 where p comes first.
int order(const ExactPoint& p, const ExactPoint& q, std::size_t axis);

/// Points by number, each of them once.
class PointTable {
public:
    /// size: the largest coordinate, metres.
    explicit PointTable(double size) : cell_(1e-9 * size), slack_(1e-14 * size) {}

    std::uint32_t add(const ExactPoint& point); ///< its number, an old one where it is there
    const ExactPoint& operator[](std::uint32_t number) const { return points_[number]; }
    std::size_t size() const { return points_.size(); }

private:
    double cell_, slack_;
    std::vector<ExactPoint> points_;
    std::map<std::array<double, 3>, std::vector<std::uint32_t>> cells_;
};

} // namespace raycontact
