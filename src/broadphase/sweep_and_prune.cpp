// SPDX-License-Identifier: Apache-2.0
#include "broadphase/sweep_and_prune.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

// The axis of largest variance of the boxes' middles: fewest overlaps per box.
std::size_t widest_axis(const std::vector<WorldBox>& boxes) {
    Vec3 mean, spread;
    for (const WorldBox& box : boxes) mean = mean + box.middle();
    mean = (1 / static_cast<double>(boxes.size())) * mean;
    for (const WorldBox& box : boxes) {
        const Vec3 d = box.middle() - mean;
        spread = spread + Vec3{d.x * d.x, d.y * d.y, d.z * d.z};
    }
    return spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
}

} // namespace

Box world_box(const Box& own, const Pose& pose, double grow) {
    const auto& r = pose.rotation;
    const Vec3 half = 0.5 * (own.high - own.low) + Vec3{grow, grow, grow};
    const Vec3 c = transform_point(pose, own.middle());
    // A billionth of the box covers the rounding of this very computation.
    const double slack = 1e-9 * (half.x + half.y + half.z) + 1e-15 * (std::fabs(c.x) + std::fabs(c.y) + std::fabs(c.z));
    const Vec3 e{std::fabs(r[0]) * half.x + std::fabs(r[1]) * half.y + std::fabs(r[2]) * half.z + slack,
                 std::fabs(r[3]) * half.x + std::fabs(r[4]) * half.y + std::fabs(r[5]) * half.z + slack,
                 std::fabs(r[6]) * half.x + std::fabs(r[7]) * half.y + std::fabs(r[8]) * half.z + slack};
    return {c - e, c + e};
}

void sweep_and_prune(std::vector<WorldBox>& boxes, std::vector<SlotPair>& pairs) {
    pairs.clear();
    if (boxes.size() < 2) return;
    const std::size_t first = widest_axis(boxes), second = (first + 1) % 3, third = (first + 2) % 3;
    std::sort(boxes.begin(), boxes.end(), [first](const WorldBox& a, const WorldBox& b) {
        const double x = axis(a.low, first), y = axis(b.low, first);
        return x != y ? x < y : a.body < b.body;
    });
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const WorldBox& a = boxes[i];
        const double end = axis(a.high, first);
        for (std::size_t j = i + 1; j < boxes.size() && axis(boxes[j].low, first) <= end; ++j) {
            const WorldBox& b = boxes[j];
            if (axis(a.low, second) <= axis(b.high, second) && axis(b.low, second) <= axis(a.high, second)
                && axis(a.low, third) <= axis(b.high, third) && axis(b.low, third) <= axis(a.high, third))
                pairs.emplace_back(std::min(a.body, b.body), std::max(a.body, b.body));
        }
    }
    std::sort(pairs.begin(), pairs.end());
}

} // namespace raycontact
