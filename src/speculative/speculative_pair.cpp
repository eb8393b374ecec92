// SPDX-License-Identifier: Apache-2.0
#include "speculative/speculative_pair.h"

#include <algorithm>

namespace raycontact {

namespace {

std::array<OneWay, 2> bodies_of(const PlacedBody& first, const PlacedBody& second, double margin) {
    const ShapeData &a = first.shape->data(), &b = second.shape->data();
    const PairPlace now = place_pair(first.centred, second.centred, 0), next = place_pair(first.next, second.next, 0);
    const auto ways = displacement_bounds(now, next, a.reach, b.reach);
    const double way = std::min(ways[0], ways[1]);
    const double most = double(MOST_THROWN) * smaller_size(first, second);
    const auto one_way = [&](const ShapeData& source, const ShapeData& target, const Pose& from, const Pose& to) {
        const bool moves = way > margin;
        return OneWay{source, target, from, to, moves, moves ? std::min(most, thrown_share * way) : 0};
    };
    return {one_way(a, b, now.pose, next.pose), one_way(b, a, now.pose_of_second(), next.pose_of_second())};
}

} // namespace

SpeculativePair::SpeculativePair(const PlacedBody& first, const PlacedBody& second, double within)
    : a(first), b(second), margin(within), perturbation(1e-7 * smaller_size(first, second)),
      bodies(bodies_of(first, second, within)) {}

} // namespace raycontact
