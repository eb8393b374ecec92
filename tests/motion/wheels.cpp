// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/trigonometry.h>
#include <tests/holds/parts.h>
#include <tests/holds/scenes.h>
#include <tests/motion/placing.h>
#include <tests/motion/scenes.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace raycontact::scenes {

namespace {

constexpr double radius = 0.4, flange_play = 0.005; // metres; play between a flange and its rail

/// Its axis becomes y, and a side is below.
Mesh rolling(Mesh mesh, std::uint32_t sides) {
    const SineCosine half_a_side = sine_cosine(0.5 / sides);
    for (Vec3& v : mesh.vertices)
        v = {half_a_side.cosine * v.x - half_a_side.sine * v.y, v.z,
             -half_a_side.sine * v.x - half_a_side.cosine * v.y};
    return mesh;
}

Hold roll(const std::string& name, const Floor& floor, StackShape wheel, std::uint32_t sides, double speed,
          bool is_on_rails) {
    char how[120];
    std::snprintf(how, sizeof how, ", %u sides, %g m/s", sides, speed);
    Hold hold = motion(name + how, "it rolls straight on and loses no more than its corners explain", floor);
    const double down = radius * std::cos(std::numbers::pi / sides);
    const double seconds = std::min(3.0, 40 / speed);
    hold.seconds = 0.5 + seconds;
    // From 2 m/s on it is in the air from corner to corner, and small errors turn it.
    const double play = is_on_rails ? 2 * flange_play : 0.01 * speed * seconds;
    const std::size_t shape = hold.stack.shapes.size();
    hold.stack.shapes.push_back(std::move(wheel));
    hold.stack.bodies.push_back({.shape = shape, .pose = at(-20, 0, down), .friction = 0.5});
    const Launch launch{{speed, 0, 0}, {0, speed / radius, 0}};
    hold.course = [=] { return std::make_unique<Roll>(std::vector{launch}, radius, static_cast<int>(sides), play); };
    return hold;
}

/// A floor of 48 x 4 m, in cells of 0.25 m or whole; or two rails 1.5 m apart, whole or of pieces of 1 m.
Floor lane(bool whole) {
    return {whole ? "a floor of one cell" : "a floor of 192 x 16 cells",
            {shape_of(sheet(48, 4, whole ? 1 : 192, whole ? 1 : 16, 1), true)},
            {{.fixed = true}}};
}

constexpr double gauge = 1.5, tread = 0.07;

Floor rails(bool whole) {
    const double piece = whole ? 48 : 1;
    Floor floor{whole ? "rails" : "rails of 1 m", {box_of({piece, tread, 0.15})}, {}};
    for (const double side : {-gauge / 2, gauge / 2})
        for (double x = -24 + piece / 2; x < 24; x += piece)
            floor.bodies.push_back({.pose = at(x, side, -0.075), .fixed = true});
    return floor;
}

/// Two wheels on an axle, along z, each with a flange inside its rail.
Mesh wheelset(std::uint32_t sides) {
    const double outer = gauge / 2 + tread, inner = gauge / 2 - tread / 2 - flange_play, axle = 0.06;
    return axle_with_wheels(radius, radius + 0.03, axle, inner - 0.03, inner, outer, sides);
}

} // namespace

std::vector<Hold> rolls() {
    std::vector<Hold> all;
    for (const std::uint32_t sides : {32U, 64U, 128U}) {
        const StackShape wheel = shape_of(rolling(frustum(radius, radius, 0.3, sides), sides), true);
        for (const double speed : {1.0, 5.0, 20.0})
            for (const bool whole : {true, false}) {
                if (whole && sides != 64) continue;
                Floor floor = lane(whole);
                all.push_back(roll("wheel on " + floor.name, floor, wheel, sides, speed, false));
            }
        const StackShape set = shape_of(rolling(wheelset(sides), sides), false);
        for (const double speed : {1.0, 5.0, 20.0})
            for (const bool whole : {true, false}) {
                if (whole && sides != 128) continue;
                Floor floor = rails(whole);
                all.push_back(roll("wheelset on " + floor.name, floor, set, sides, speed, true));
            }
    }
    return all;
}

} // namespace raycontact::scenes
