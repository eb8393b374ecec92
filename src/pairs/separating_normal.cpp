// SPDX-License-Identifier: Apache-2.0
#include "pairs/separating_normal.h"

#include "mesh/vector.h"
#include "pairs/displacement.h"
#include "shape/accelerators.h"

#include <algorithm>

namespace raycontact {

namespace {

// Directions tried for a pair in a step; the next step goes on from the best.
constexpr int most_directions = 4;

// From the farthest point of the target against the normal to the nearest of the source along it.
Vec3 least_way(const Supports& source, const Supports& target, const Pose& place, const Vec3& normal) {
    const Vec3 nearest = source.point(-1.0 * rotated_back(place.rotation, normal));
    return transform_point(place, nearest) - target.point(normal);
}

} // namespace

double SeparatingNormal::gap(const PlacedBody& a, const PlacedBody& b, double enough, bool on_way) {
    const Accelerators *more_a = accelerators_of(*a.shape), *more_b = accelerators_of(*b.shape);
    if (more_a == nullptr || more_b == nullptr) return 0;
    const Supports &first = more_a->supports, &second = more_b->supports;
    const PairPlace now = place_pair(a.centred, b.centred, 0);
    const PairPlace next = on_way ? place_pair(a.next, b.next, 0) : now;
    const auto way = [&](const Vec3& normal) {
        const Vec3 here = least_way(first, second, now.pose, normal);
        if (!on_way) return here;
        const Vec3 then = least_way(first, second, next.pose, normal);
        return dot(then, normal) >= dot(here, normal) ? here : then;
    };
    // The frames of the two may differ, since rotations are rigid only nearly.
    const auto back = [&](const Vec3& normal) {
        const Vec3 turned = unit(-1.0 * rotated_back(now.pose.rotation, normal));
        const double here = dot(least_way(second, first, now.pose_of_second(), turned), turned);
        return on_way ? std::min(here, dot(least_way(second, first, next.pose_of_second(), turned), turned)) : here;
    };
    const double far = length(now.pose.translation);
    if (!(far > 0 && far < 1e100)) return 0; // farther, squares overflow
    Vec3 normal = normal_ == Vec3{} ? (1 / far) * now.pose.translation : normal_;
    double best = -1e300;
    for (int tried = 0; tried < most_directions; ++tried) {
        const Vec3 nearest = way(normal);
        const double apart = dot(nearest, normal);
        if (apart > best) {
            best = apart;
            normal_ = normal;
        }
        if (apart > enough) break;
        // Up the slope of `apart`: of two balls it is the direction of their centres.
        normal = unit(normal + (1 / far) * (nearest - apart * normal));
        if (normal == Vec3{}) break;
    }
    return best > 0 ? std::min(best, back(normal_)) : best;
}

} // namespace raycontact
