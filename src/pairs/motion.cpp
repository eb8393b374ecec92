// SPDX-License-Identifier: Apache-2.0
#include "pairs/motion.h"

#include "mesh/vector.h"
#include "pairs/displacement.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {
constexpr double lost_of_float = 6e-8;    // of a length, by rounding its components
constexpr double lost_of_squares = 1e-22; // metres, where they underflow

void round_to(float (&to)[3], const Vec3& from) {
    to[0] = static_cast<float>(from.x);
    to[1] = static_cast<float>(from.y);
    to[2] = static_cast<float>(from.z);
}

float distance(const float (&a)[3], const float (&b)[3]) {
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return std::sqrt((x * x + y * y) + z * z);
}

// How far a straight way in the frame of a body that turns is from the true one: an eighth of the second derivative, of
// what is `far` away and goes `way` besides. A turn is up to pi / 3 of 1, at most pi / 2 of what turn_bound() says.
float arc_of(float turn, float far, float way) {
    return turn <= 1 ? turn * (0.14f * turn * far + 0.27f * way) : turn * (0.32f * turn * far + 0.4f * way);
}
} // namespace

void Motion::update(Executor& executor, std::span<const PlacedBody> bodies, const SlotChanges& moved) {
    bodies_.resize(bodies.size());
    lasts_.resize(bodies.size());
    const bool steps_passed = !moved.is_next(seen_);
    if (any_moving_) seen_ = 0;
    const bool all = moved.each_since(seen_, executor, bodies.size(), [&](BodySlot body) { follow(bodies, body); });
    // What moved in the last step alone rests now.
    if (!all)
        executor.each(moving_.size(), 512, [&](std::uint32_t i) {
            if (moving_[i] < bodies.size() && !moved.is_marked(moving_[i])) follow(bodies, moving_[i]);
        });
    moving_.assign(moved.list().begin(), moved.list().end());
    any_moving_ = steps_passed;
}

void Motion::follow(std::span<const PlacedBody> bodies, BodySlot body) {
    Last& last = lasts_[body];
    if (bodies[body].shape == nullptr) {
        last.known = false;
        return;
    }
    const Pose& now = bodies[body].centred;
    // Steps of a method that asks for no motion may have passed, and a body with them.
    const bool known = last.known && last.generation == bodies[body].generation;
    const double shear = shear_bound(now);
    bodies_[body] = body_of(bodies[body], known ? last.centred : now, now, std::max(shear, last.shear));
    last = {now, shear, bodies[body].generation, true};
}

void Motion::expect(Executor& executor, std::span<const PlacedBody> bodies, const SlotChanges& moved) {
    if (next_.size() != bodies.size()) next_.resize(bodies.size());
    moved.each_since(expected_, executor, bodies.size(), [&](BodySlot body) {
        if (bodies[body].shape == nullptr) return;
        const Pose &now = bodies[body].centred, &next = bodies[body].next;
        next_[body] = body_of(bodies[body], now, next, std::max(lasts_[body].shear, shear_bound(next)));
    });
}

// `apart` is taken where the motion ends.
Motion::Body Motion::body_of(const PlacedBody& body, const Pose& from, const Pose& to, double shear) {
    Body moved;
    const Vec3 shift = to.translation - from.translation;
    round_to(moved.shift, shift);
    round_to(moved.centre, to.translation);
    moved.centre_lost = static_cast<float>(lost_of_float * length(to.translation));
    const double far = length(shift);
    moved.shift_lost = far > 0 ? static_cast<float>(lost_of_float * far + lost_of_squares) : 0.0f;
    moved.turn = static_cast<float>(turn_bound(from, to, shear));
    moved.warp = moved.turn > 0 ? static_cast<float>(2 * shear) : 0.0f;
    moved.reach = static_cast<float>(body.shape->data().reach);
    return moved;
}

Motion::Bound Motion::bound(std::span<const Body> bodies, const SlotPair& pair) {
    const Body &a = bodies[pair.first], &b = bodies[pair.second];
    const float still = distance(a.shift, b.shift) + (a.shift_lost + b.shift_lost);
    // The target's turn sweeps the source along, at its distance. Rotations are rigid to 1e-4, hence the thousandth.
    const float apart = distance(a.centre, b.centre) + (a.centre_lost + b.centre_lost);
    const float a_turned = a.turn * a.reach + b.turn * (apart + a.reach);
    const float b_turned = b.turn * b.reach + a.turn * (apart + b.reach);
    const float arc = std::max(arc_of(b.turn, apart + still + a.reach, still + a.turn * a.reach),
                               arc_of(a.turn, apart + still + b.reach, still + b.turn * b.reach));
    return {1.001 * double(still + std::max(a_turned, b_turned)), 1.001 * double(still + std::min(a_turned, b_turned)),
            1.001 * double(still + (((a.turn + a.warp) * a.reach + (b.turn + b.warp) * b.reach) + arc))};
}

double Motion::pair_way(const SlotPair& pair, double margin) const {
    if (next_.empty()) return 0;
    const Bound way = bound(next_, pair);
    return way.moved_least > margin ? way.nearer : 0;
}

double Motion::pair_speed(const SlotPair& pair) const {
    const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
    return double(distance(a.shift, b.shift)) + double(std::max(a.turn * a.reach, b.turn * b.reach));
}

} // namespace raycontact
