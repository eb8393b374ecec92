// SPDX-License-Identifier: Apache-2.0
#include <tests/holds/scenes.h>
#include <tests/motion/placing.h>
#include <tests/motion/scenes.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace raycontact::scenes {

namespace {

constexpr double gravity = 9.81; // m/s^2

/// At most so fast that its weight keeps it from going over a step's edge.
constexpr double slow = 2;

/// Metres by which a box goes on when a step stops its foot: it turns about the step's edge, until its weight stops it.
double tips_by(const Vec3& size, double rise) {
    const double back = size.x / 2, up = size.z / 2 - rise;
    if (up <= 0) return 0;
    const double arm2 = back * back + up * up, inertia = (size.x * size.x + size.z * size.z) / 12 + arm2;
    const double spin = slow * up / inertia, top = up + spin * spin * inertia / (2 * gravity);
    return back - std::sqrt(std::max(0.0, arm2 - top * top));
}

/// rise: metres, above the margin, which is 0.25 % of the body's diagonal.
Hold wall(const Mover& mover, const Floor& floor, double rise, double reach) {
    Hold hold = motion(mover.name + " at " + floor.name, "a step higher than the margin stops 5 at 2 m/s", floor);
    const std::size_t shape = hold.stack.shapes.size();
    hold.stack.shapes.push_back(mover.shape);
    // They come to it at other parts of a step's way.
    for (int k = 0; k < 5; ++k)
        hold.stack.bodies.push_back(
            {.shape = shape, .pose = at(-0.7 - 0.0071 * k, 0.5 * k - 1, mover.low), .friction = 0});
    hold.seconds = 1.5;
    const double past = 2e-3 + tips_by(mover.shape.box.value_or(Vec3{}), rise);
    hold.course = [=] { return std::make_unique<Halt>(std::vector<Launch>(5, {{slow, 0, 0}, {}}), reach, past); };
    return hold;
}

Hold fall(const Mover& mover, const Floor& floor, double restitution) {
    constexpr double height = 1;
    char how[120];
    std::snprintf(how, sizeof how, " falls by 1 m on %s, restitution %g", floor.name.c_str(), restitution);
    Hold hold = motion(mover.name + how, "5 bounce to the height times restitution squared, within 10 %", floor);
    const std::size_t shape = hold.stack.shapes.size();
    hold.stack.shapes.push_back(mover.shape);
    std::vector<double> drops;
    for (int k = 0; k < 5; ++k) {
        drops.push_back(height + 0.03 * k);
        hold.stack.bodies.push_back(
            {.shape = shape, .pose = at(0.05 + 0.5 * k, 0.021, mover.low + drops.back()), .friction = 0});
    }
    hold.seconds = 1.2;
    hold.course = [=] { return std::make_unique<Fall>(drops, restitution); };
    return hold;
}

/// Between two closed walls, 2 m apart.
Hold to_and_fro(const Mover& mover, double half) {
    Floor walls{"walls", {box_of({1, 4, 4})}, {}};
    for (const double side : {-1.5, 1.5}) walls.bodies.push_back({.pose = at(side, 0, 0), .fixed = true});
    Hold hold =
        motion(mover.name + " between two walls", "at 5 m/s it comes back each time at its speed, within 10 %", walls);
    hold.stack.gravity = 0;
    hold.stack.shapes.push_back(mover.shape);
    hold.stack.bodies.push_back({.shape = 1, .pose = at(0.07, 0.03, 0.05), .friction = 0});
    hold.seconds = 4;
    hold.course = [=] { return std::make_unique<ToAndFro>(std::vector<Launch>{{{5, 0, 0}, {}}}, 2 - 2 * half); };
    return hold;
}

} // namespace

std::vector<Hold> bounces() {
    std::vector<Hold> all;
    for (const double rise : {0.003, 0.01, 0.05, 0.15}) {
        all.push_back(wall(box(), stepped_floor(rise), rise, 0.15));
        all.push_back(wall(box(), flush_floor(0, rise), rise, 0.15));
    }
    all.push_back(wall(cylinder(), stepped_floor(0.15), 0.15, 0.15));
    all.push_back(wall(bullet_box(), stepped_floor(0.15), 0.15, 0.15));
    all.push_back(wall(bullet_ball(), stepped_floor(0.15), 0.15, 0.1));
    all.push_back(to_and_fro(box(), 0.15));
    all.push_back(fall(box(), open_floor(100, 100), 0.8));
    for (const Mover& mover : {box(), cylinder(), pebble(), bullet_box(), bullet_ball(), bullet_capsule()})
        for (const Floor& floor : {closed_floor(1, 1), closed_floor(100, 100)}) all.push_back(fall(mover, floor, 0.5));
    all.push_back(fall(bullet_ball(), open_floor(100, 100), 0.8));
    all.push_back(to_and_fro(bullet_ball(), 0.1));
    return all;
}

} // namespace raycontact::scenes
