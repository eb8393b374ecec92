// SPDX-License-Identifier: Apache-2.0
#include "pairs/motion.h"

#include "mesh/vector.h"
#include "pairs/displacement.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

void Motion::update(Executor& executor, std::span<const PlacedBody> bodies) {
    bodies_.resize(bodies.size());
    executor.run(static_cast<std::uint32_t>(bodies.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            Body& body = bodies_[i];
            if (bodies[i].shape == nullptr) {
                body.known = false;
                continue;
            }
            const Pose& now = bodies[i].centred;
            if (body.known && body.centred == now) {
                body.shift = {};
                body.origin = body.turn = 0;
                continue;
            }
            body.reach = bodies[i].shape->data().reach;
            const double shear = shear_bound(now);
            const Pose& before = body.known ? body.centred : now;
            body.shift = now.translation - before.translation;
            body.origin = length(body.shift);
            body.turn = turn_bound(before, now, std::max(shear, body.shear));
            body.shear = shear;
            body.centred = now;
            body.known = true;
        }
    });
}

double Motion::pair_bound(const Pair& pair) const {
    const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
    const double still = a.origin + b.origin;
    if (a.turn == 0 && b.turn == 0) return 1.001 * still;
    // A turning target sweeps the source along at their distance. Rotations are rigid to 1e-4, hence the thousandth.
    const double apart = length(a.centred.translation - b.centred.translation);
    const double reach = std::max(a.reach, b.reach);
    return 1.001 * (still + (a.turn + b.turn) * (apart + reach));
}

double Motion::pair_speed(const Pair& pair) const {
    const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
    return length(a.shift - b.shift) + std::max(a.turn * a.reach, b.turn * b.reach);
}

} // namespace raycontact
