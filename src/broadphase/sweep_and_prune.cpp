// SPDX-License-Identifier: Apache-2.0
#include "broadphase/sweep_and_prune.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

double along(const Vec3& v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// The axis of largest variance of the boxes' middles: fewest overlaps per box.
int widest_axis(const std::vector<WorldBox>& boxes) {
    int widest = 0;
    double largest = -1;
    for (int axis = 0; axis < 3; ++axis) {
        double mean = 0, spread = 0;
        for (const WorldBox& box : boxes) mean += 0.5 * (along(box.low, axis) + along(box.high, axis));
        mean /= static_cast<double>(boxes.size());
        for (const WorldBox& box : boxes) {
            const double d = 0.5 * (along(box.low, axis) + along(box.high, axis)) - mean;
            spread += d * d;
        }
        if (spread > largest) {
            largest = spread;
            widest = axis;
        }
    }
    return widest;
}

} // namespace

WorldBox world_box(BodySlot body, const Vec3& box_min, const Vec3& box_max, const Pose& pose, double grow) {
    const auto& r = pose.rotation;
    const Vec3 middle{0.5 * (box_min.x + box_max.x), 0.5 * (box_min.y + box_max.y), 0.5 * (box_min.z + box_max.z)};
    const Vec3 half{0.5 * (box_max.x - box_min.x) + grow, 0.5 * (box_max.y - box_min.y) + grow,
                    0.5 * (box_max.z - box_min.z) + grow};
    const Vec3 c = transform_point(pose, middle);
    // A billionth of the box covers the rounding of this very computation.
    const double slack = 1e-9 * (half.x + half.y + half.z) + 1e-15 * (std::fabs(c.x) + std::fabs(c.y) + std::fabs(c.z));
    const Vec3 e{std::fabs(r[0]) * half.x + std::fabs(r[1]) * half.y + std::fabs(r[2]) * half.z + slack,
                 std::fabs(r[3]) * half.x + std::fabs(r[4]) * half.y + std::fabs(r[5]) * half.z + slack,
                 std::fabs(r[6]) * half.x + std::fabs(r[7]) * half.y + std::fabs(r[8]) * half.z + slack};
    return {body, {c.x - e.x, c.y - e.y, c.z - e.z}, {c.x + e.x, c.y + e.y, c.z + e.z}};
}

void SweepAndPrune::find_pairs(std::vector<WorldBox>& boxes, std::vector<SlotPair>& pairs) const {
    pairs.clear();
    if (boxes.size() < 2) return;
    const int axis = widest_axis(boxes), second = (axis + 1) % 3, third = (axis + 2) % 3;
    std::sort(boxes.begin(), boxes.end(), [axis](const WorldBox& a, const WorldBox& b) {
        const double x = along(a.low, axis), y = along(b.low, axis);
        return x != y ? x < y : a.body < b.body;
    });
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const WorldBox& a = boxes[i];
        const double end = along(a.high, axis);
        for (std::size_t j = i + 1; j < boxes.size() && along(boxes[j].low, axis) <= end; ++j) {
            const WorldBox& b = boxes[j];
            if (along(a.low, second) <= along(b.high, second) && along(b.low, second) <= along(a.high, second)
                && along(a.low, third) <= along(b.high, third) && along(b.low, third) <= along(a.high, third))
                pairs.emplace_back(std::min(a.body, b.body), std::max(a.body, b.body));
        }
    }
    std::sort(pairs.begin(), pairs.end());
}

} // namespace raycontact
