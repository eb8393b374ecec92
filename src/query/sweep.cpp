// SPDX-License-Identifier: Apache-2.0
#include "query/sweep.h"

#include "broadphase/world_box.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double turn_of_piece = 0.25; ///< radians; more where there would be too many pieces
constexpr double most_pieces = 64;

double size_of(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

} // namespace

Box box_around(const Shape& shape, const Pose& pose) {
    return world_box({shape.box_min(), shape.box_max()}, pose, rounding_of(shape.data()));
}

double entry_of(const Box& box, const Vec3& origin, const Vec3& direction) {
    double enter = 0, leave = infinite;
    for (std::size_t k = 0; k < 3; ++k) {
        const double o = axis(origin, k), d = axis(direction, k), inverse = 1 / (std::fabs(d) > 1e-20 ? d : 1e-20);
        const double slack = 1e-14 * std::fabs(o);
        const double t0 = (axis(box.low, k) - slack - o) * inverse, t1 = (axis(box.high, k) + slack - o) * inverse;
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return enter <= leave * (1 + 1e-14) ? enter * (1 - 1e-14) : infinite;
}

// While a point turns about the shape's centre by an angle, it is no farther from where it would be without turning
// than the angle times its distance; the centre itself leaves its chord by an eighth of its acceleration times the
// square of the time, at most.
Sweep::Sweep(const Shape& shape, const RigidMotion& motion, double distance)
    : shape_(shape), start_(motion.from), motion_(checked_motion(motion, "motion of the mesh")), distance_(distance) {
    const Nearness near = checked_nearness(shape, shape, distance, 0);
    const double rate = length(motion_.angular_velocity);
    const double count = std::clamp(std::ceil(rate / turn_of_piece), 1.0, most_pieces), time = 1 / count;
    const Vec3 arm = rotated(motion_.from.rotation, shape.data().centre) - motion_.centre;
    const double bulge = rate * length(cross(motion_.angular_velocity, arm)) * time * time / 8;
    const double turned = std::min(rate * time / 2, 2.0) * shape.data().reach;
    const auto centre_at = [&](double when) { return transform_point(pose_at(motion_, when), shape.data().centre); };
    for (double number = 0; number < count; ++number) {
        const double begin = number * time;
        const Vec3 from = centre_at(begin), to = centre_at(begin + time);
        const Box box = box_around(shape, pose_at(motion_, begin + time / 2));
        const Vec3 middle = box.middle() - centre_at(begin + time / 2);
        const double grow = near.distance + near.tolerance + bulge + turned
                            + 1e-12 * (size_of(from) + size_of(to) + shape.data().reach);
        pieces_.push_back({begin, time, from + middle, to - from, 0.5 * (box.high - box.low) + Vec3{grow, grow, grow}});
    }
}

double Sweep::earliest(const Box& box) const {
    for (const Piece& piece : pieces_) {
        const double entry = entry_of({box.low - piece.half, box.high + piece.half}, piece.from, piece.way);
        if (entry <= 1) return piece.begin + entry * piece.length;
    }
    return infinite;
}

std::optional<Impact> Sweep::at_start(const Shape& body, const Pose& pose) const {
    return impact_at_start(shape_, start_, body, pose, checked_nearness(shape_, body, distance_, 0));
}

std::optional<Impact> Sweep::on_the_way(const Shape& body, const Pose& pose, double begin, double latest) const {
    if (begin > latest) return std::nullopt;
    return impact_on_the_way(shape_, motion_, body, no_motion(pose), checked_nearness(shape_, body, distance_, 0),
                             begin, latest);
}

} // namespace raycontact
