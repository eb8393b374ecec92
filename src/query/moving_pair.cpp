// SPDX-License-Identifier: Apache-2.0
#include "query/moving_pair.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

Vec3 centre_of(const RigidMotion& motion) {
    return motion.from.translation + motion.centre;
}

} // namespace

MovingPair::MovingPair(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b)
    : a_(a), b_(b), motion_a_(motion_a), motion_b_(motion_b), rate_a_(length(motion_a.angular_velocity)),
      rate_b_(length(motion_b.angular_velocity)),
      difference_(length(motion_a.angular_velocity - motion_b.angular_velocity)), turning_(rate_a_ + rate_b_),
      parallel_(length(cross(motion_a.angular_velocity, motion_b.angular_velocity)) <= 1e-14 * rate_a_ * rate_b_) {
    const Vec3 before = centre_of(motion_a) - centre_of(motion_b), velocity = motion_a.velocity - motion_b.velocity;
    const auto seen = [&](const Shape& shape, const RigidMotion& own, const RigidMotion& other) {
        const Vec3& spin = other.angular_velocity;
        const double rate = length(spin);
        // Of centres that move straight: the square of their distance from an axis is convex in time.
        const auto around = [&](const Vec3& v) { return length(cross(spin, v)); };
        const double most = std::max(around(before), around(before + velocity));
        const Rate change{0, rate > 0 ? most + 2 * around(velocity) / rate : 0};
        return Seen{rotated_back(own.from.rotation, own.centre) - queried(shape).centre,
                    rotated_back(own.from.rotation, own.angular_velocity),
                    {change, {0, 3 * around(velocity) + rate * most}}};
    };
    seen_a_ = seen(a, motion_a, motion_b);
    seen_b_ = seen(b, motion_b, motion_a);
    const double bends = std::max(bend(Side::a, {}, queried(a).reach).change.along(most_across(Side::b)),
                                  bend(Side::b, {}, queried(b).reach).change.along(most_across(Side::a)));
    turning_ = std::min(turning_, std::sqrt(bends / std::min(queried(a).reach, queried(b).reach)));
}

// With w the spin of the own body, v that of the other and q the point from the own centre, the frame of the other sees
// d/dt q = (w - v) x q, and of any vector that it sees, p, d/dt p - v x p. So, with D and W for the products with w - v
// and w, V for that with v, the velocity changes by D W q - V D q, that by D W W q - 2 V D W q + V V D q; and both by
// what the centres add, C and their velocity: V V C - 2 V velocity, and 3 V V velocity - V V V C. All begin with D or
// V, whose part along a direction is no more than |direction x (w - v)|, or |direction x v|, times what follows.
MovingPair::Bend MovingPair::bend(Side side, const Vec3& middle, double radius) const {
    const Seen& own = side == Side::a ? seen_a_ : seen_b_;
    if (difference_ == 0) return own.drift;
    const double rate = side == Side::a ? rate_a_ : rate_b_, other = side == Side::a ? rate_b_ : rate_a_;
    const Vec3 off = middle - own.centre;
    const double circling = length(cross(own.spin, off)) + rate * radius;
    const double shearing = other > 0 ? difference_ * (length(off) + radius) : 0;
    return {{circling, shearing + own.drift.change.own},
            {rate * circling, 2 * difference_ * circling + other * shearing + own.drift.of_change.own}};
}

Vec3 MovingPair::Moment::change(Side side, const Vec3& point) const {
    const Vec3 from_a = point - centre_a, from_b = point - centre_b;
    const Vec3 velocity = seen_in_b.at(point); // of a's points past b
    const Vec3 inward_a = cross(spin_a, cross(spin_a, from_a)), inward_b = cross(spin_b, cross(spin_b, from_b));
    return side == Side::a ? (inward_a - inward_b) - 2 * cross(spin_b, velocity)
                           : (inward_b - inward_a) + 2 * cross(spin_a, velocity);
}

MovingPair::Moment MovingPair::at(double time) const {
    const Pose pose_a = pose_at(motion_a_, time), pose_b = pose_at(motion_b_, time);
    Moment moment{time, ShapePair(a_, pose_a, b_, pose_b), {}, {}, {}, {}, {}, {}};
    const Vec3 origin = transform_point(pose_b, queried(b_).centre);
    const auto in_b = [&](const Vec3& v) { return rotated_back(pose_b.rotation, v); };
    moment.centre_a = in_b(centre_of(motion_a_) + time * motion_a_.velocity - origin);
    moment.centre_b = in_b(centre_of(motion_b_) + time * motion_b_.velocity - origin);
    moment.spin_a = in_b(motion_a_.angular_velocity);
    moment.spin_b = in_b(motion_b_.angular_velocity);
    const Vec3 passing = in_b(motion_a_.velocity - motion_b_.velocity);
    moment.seen_in_b = {passing - cross(moment.spin_a, moment.centre_a) + cross(moment.spin_b, moment.centre_b),
                        moment.spin_a - moment.spin_b};
    const Pose& a_in_b = moment.pair.out_of(Side::a);
    const auto in_a = [&](const Vec3& v) { return Vec3{} - rotated_back(a_in_b.rotation, v); };
    moment.seen_in_a = {in_a(moment.seen_in_b.at(a_in_b.translation)), in_a(moment.seen_in_b.spin)};
    return moment;
}

} // namespace raycontact
