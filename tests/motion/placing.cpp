// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/placing.h>

#include <scenes/models/trigonometry.h>
#include <tests/holds/scenes.h>

#include "mesh/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::scenes {

Hold motion(std::string name, std::string means, const Floor& floor) {
    Hold hold;
    hold.name = std::move(name);
    hold.means = std::move(means);
    hold.stack = {hold.name, floor.shapes, floor.bodies};
    for (StackBody& body : hold.stack.bodies) body.friction = 1;
    hold.ground = Ground::none;
    hold.slop = std::nullopt;
    hold.deepest = std::nullopt;
    hold.rest = std::nullopt;
    return hold;
}

std::vector<Launch> star(double speed) {
    std::vector<Launch> all;
    for (int k = 0; k < 12; ++k) {
        const SineCosine way = sine_cosine(k / 12.0);
        all.push_back({{speed * way.cosine, speed * way.sine, 0}, {}});
    }
    return all;
}

void add_star(Stack& stack, const Mover& mover, const std::vector<Launch>& launches, double before, double friction,
              double rise) {
    // Off the middle, so that no body goes along a mesh's edges all the way.
    constexpr Vec3 middle{0.037, 0.021, 0};
    const std::size_t shape = stack.shapes.size();
    stack.shapes.push_back(mover.shape);
    for (const Launch& launch : launches) {
        const Vec3 way = unit(launch.velocity);
        Vec3 place = middle - before * way;
        place.z = mover.low + (place.x > 0 ? rise : 0);
        const double turns = std::atan2(way.y, way.x) / (2 * std::numbers::pi);
        stack.bodies.push_back({.shape = shape, .pose = turned_at(place, {0, 0, 1}, turns), .friction = friction});
    }
}

} // namespace raycontact::scenes
