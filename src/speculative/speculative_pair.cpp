// SPDX-License-Identifier: Apache-2.0
#include "speculative/speculative_pair.h"

#include <algorithm>

namespace raycontact {

namespace {

// Of the longest way of a body's points: a rod that falls flat and is stopped at one end turns the other so much
// farther.
constexpr double thrown_share = 0.5;
// Of the smaller body's diagonal: farther off there are too many places, and they are not asked.
constexpr double most_thrown = 0.05;

std::array<OneWay, 2> bodies_of(const PlacedBody& first, const PlacedBody& second, double margin) {
    const ShapeData &a = first.shape->data(), &b = second.shape->data();
    const PairPlace now = place_pair(first.centred, second.centred, 0), next = place_pair(first.next, second.next, 0);
    const auto ways = displacement_bounds(now, next, a.reach, b.reach);
    const double most = most_thrown * smaller_size(first, second);
    const auto thrown = [&](double way) { return std::min(most, thrown_share * way); };
    return {OneWay{a, b, now.pose, next.pose, ways[0] > margin, thrown(ways[0])},
            OneWay{b, a, now.pose_of_second(), next.pose_of_second(), ways[1] > margin, thrown(ways[1])}};
}

} // namespace

SpeculativePair::SpeculativePair(const PlacedBody& first, const PlacedBody& second, double within)
    : a(first), b(second), margin(within), perturbation(1e-7 * smaller_size(first, second)),
      bodies(bodies_of(first, second, within)) {}

} // namespace raycontact
