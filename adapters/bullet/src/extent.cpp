// SPDX-License-Identifier: Apache-2.0
#include <extent.h>

#include <algorithm>

namespace raycontact::bullet {

void Extent::add(const btVector3& centre, const btVector3& half) {
    const std::size_t lane = size_++ % width;
    if (lane == 0) groups_.emplace_back();
    points_ = points_ && half.isZero();
    for (int k = 0; k < 3; ++k)
        for (std::size_t i = lane; i < width; ++i) { // the lanes after it repeat it until they are taken
            groups_.back().centre[static_cast<std::size_t>(k)][i] = centre[k];
            groups_.back().half[static_cast<std::size_t>(k)][i] = half[k];
        }
}

void Extent::bounds(const btTransform& transform, btVector3& low, btVector3& high) const {
    for (int axis = 0; axis < 3; ++axis) {
        const btVector3& row = transform.getBasis()[axis];
        const btScalar x = row.x(), y = row.y(), z = row.z();
        const btScalar ax = btFabs(x), ay = btFabs(y), az = btFabs(z);
        Lanes least, most;
        least.fill(BT_LARGE_FLOAT);
        most.fill(-BT_LARGE_FLOAT);
        const auto add = [&](const Group& group, const Lanes& reach) {
            const auto& [cx, cy, cz] = group.centre;
            for (std::size_t i = 0; i < width; ++i) {
                const btScalar at = x * cx[i] + y * cy[i] + z * cz[i];
                const btScalar from = at - reach[i], to = at + reach[i];
                least[i] = from < least[i] ? from : least[i];
                most[i] = to > most[i] ? to : most[i];
            }
        };
        constexpr Lanes none{};
        for (const Group& group : groups_) {
            if (points_) {
                add(group, none);
                continue;
            }
            const auto& [hx, hy, hz] = group.half;
            Lanes reach;
            for (std::size_t i = 0; i < width; ++i) reach[i] = ax * hx[i] + ay * hy[i] + az * hz[i];
            add(group, reach);
        }
        low[axis] = *std::min_element(least.begin(), least.end()) + transform.getOrigin()[axis];
        high[axis] = *std::max_element(most.begin(), most.end()) + transform.getOrigin()[axis];
    }
    low.setW(0);
    high.setW(0);
}

} // namespace raycontact::bullet
