// SPDX-License-Identifier: Apache-2.0
#include <tests/holds/scenes.h>
#include <tests/motion/placing.h>
#include <tests/motion/scenes.h>

#include "mesh/vector.h"

#include <cmath>
#include <numbers>

namespace raycontact::scenes {

namespace {

// An edge between two cells turns a body by cell / radius, which takes the square of that of its energy. In 6 s a body
// meets about 120 in the bowl, which take 1.2 %, and 90 on the waves, of 32 m radius, which take 0.4 %.
constexpr double loses = 0.03;

Floor terrain(const char* name, double size, double cell, bool closed, const Height& height) {
    const auto cells = static_cast<std::uint32_t>(std::lround(size / cell));
    return {name, {shape_of(sheet(size, size, cells, cells, closed ? 1 : 0, height), false)}, {{.fixed = true}}};
}

/// 12 begin at rest, 3 m from the middle of a bowl of 10 m radius.
Hold bowl(const Mover& mover, bool closed) {
    constexpr double radius = 10, begin = 0.3; // metres, radians
    Hold hold = motion(mover.name + (closed ? " in a closed bowl" : " in an open bowl"),
                       "12 go to and fro without friction for 6 s, gain no energy and lose under 3 %",
                       terrain("bowl", 8, 0.1, closed,
                               [](double x, double y) { return radius - std::sqrt(radius * radius - x * x - y * y); }));
    hold.stack.shapes.push_back(mover.shape);
    // What is flat below stands on its rim.
    const Vec3 size = mover.shape.box.value_or(Vec3{});
    const double half = std::sqrt(size.x * size.x + size.y * size.y) / 2;
    const double arm = std::sqrt(radius * radius - half * half) - mover.low - 2e-4;
    for (int k = 0; k < 12; ++k) {
        const double azimuth = 2 * std::numbers::pi * (k + 0.3) / 12;
        const Vec3 out{std::cos(azimuth), std::sin(azimuth), 0};
        const Vec3 axis{out.y, -out.x, 0}; // turns what points down towards `out`
        Pose pose = turned_at({}, axis, begin / (2 * std::numbers::pi));
        pose.translation = arm * std::sin(begin) * out;
        pose.translation.z = radius - arm * std::cos(begin);
        hold.stack.bodies.push_back({.shape = 1, .pose = pose, .friction = 0});
    }
    hold.seconds = 6;
    hold.course = [=] { return std::make_unique<Coast>(std::vector<Launch>(12), radius - arm, loses); };
    return hold;
}

/// Waves of 8 m, 0.2 m from trough to crest, along x and y. 12 begin in a trough.
Hold waves(const Mover& mover, bool closed) {
    constexpr double wave = 8, high = 0.1, size = 40, speed = 2.5;
    const auto height = [](double x, double y) {
        const double k = 2 * std::numbers::pi / wave;
        return -high * (std::cos(k * x) + std::cos(k * y)) / 2;
    };
    Hold hold = motion(mover.name + (closed ? " on closed waves" : " on open waves"),
                       "12 at 2.5 m/s in as many directions coast for 6 s, gain no energy and lose under 3 %",
                       terrain("waves", size, 0.2, closed, height));
    const std::vector<Launch> launches = star(speed);
    add_star(hold.stack, mover, launches, 0, 0);
    for (StackBody& body : hold.stack.bodies)
        if (!body.fixed) body.pose.translation.z += 1e-3 - high;
    hold.seconds = 6;
    const double lowest = mover.low - high;
    hold.course = [=] { return std::make_unique<Coast>(launches, lowest, loses); };
    return hold;
}

} // namespace

std::vector<Hold> slopes() {
    std::vector<Hold> all;
    for (const Mover& mover : {bullet_ball(), box(), bullet_box()})
        for (const bool closed : {false, true}) {
            all.push_back(bowl(mover, closed));
            all.push_back(waves(mover, closed));
        }
    return all;
}

} // namespace raycontact::scenes
