// SPDX-License-Identifier: Apache-2.0
#include "pairs/motion.h"

#include "mesh/vector.h"
#include "pairs/displacement.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace raycontact {

namespace {
using PoseBits = std::array<std::uint64_t, 12>;
} // namespace

void Motion::update(Executor& executor, std::span<const PlacedBody> bodies) {
    bodies_.resize(bodies.size());
    lasts_.resize(bodies.size());
    executor.run(static_cast<std::uint32_t>(bodies.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            Body& body = bodies_[i];
            Last& last = lasts_[i];
            if (bodies[i].shape == nullptr) {
                last.known = body.still = false;
                continue;
            }
            const Pose& now = bodies[i].centred;
            // Bits, not values: 0 and -0 are one place, but not one contact.
            body.still = last.known && std::bit_cast<PoseBits>(last.centred) == std::bit_cast<PoseBits>(now);
            if (body.still) {
                body.shift = {};
                body.turn = body.lost = 0;
                continue;
            }
            const double shear = shear_bound(now);
            const Pose& before = last.known ? last.centred : now;
            body.shift = now.translation - before.translation;
            body.lost = 4e-16 * length(body.shift);
            body.turn = turn_bound(before, now, std::max(shear, last.shear));
            body.centre = now.translation;
            body.reach = bodies[i].shape->data().reach;
            last = {now, shear, true};
        }
    });
}

double Motion::pair_bound(const Pair& pair) const {
    const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
    const double still = length(a.shift - b.shift) + (a.lost + b.lost);
    if (a.turn == 0 && b.turn == 0) return 1.001 * still;
    // The target's turn sweeps the source along, at its distance. Rotations are rigid to 1e-4, hence the thousandth.
    const double apart = length(a.centre - b.centre);
    const double turned =
        std::max(a.turn * a.reach + b.turn * (apart + a.reach), b.turn * b.reach + a.turn * (apart + b.reach));
    return 1.001 * (still + turned);
}

double Motion::pair_speed(const Pair& pair) const {
    const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
    return length(a.shift - b.shift) + std::max(a.turn * a.reach, b.turn * b.reach);
}

} // namespace raycontact
