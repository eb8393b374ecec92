// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/trigonometry.h>
#include <tests/holds/scenes.h>
#include <tests/motion/courses.h>
#include <tests/motion/floors.h>
#include <tests/motion/movers.h>
#include <tests/motion/placing.h>
#include <tests/motion/scenes.h>

#include <cmath>

namespace raycontact::scenes {

namespace {

constexpr double speed = 5, gravity = 9.81; // m/s, m/s^2

Hold free_slide(const Mover& mover, const Floor& floor) {
    Hold hold = motion(mover.name + " slides on " + floor.name,
                       "12 at 5 m/s, each in another direction, keep speed, height and turn to 1 %", floor);
    const std::vector<Launch> launches = star(speed);
    add_star(hold.stack, mover, launches, 4.7, 0);
    hold.seconds = 2.5;
    hold.course = [=] { return std::make_unique<Slide>(launches, 0, SlideBounds{}); };
    return hold;
}

/// Along x and y alone: Bullet's friction is a pyramid, and elsewhere takes more than friction times load.
Hold braked_slide(const Mover& mover, const Floor& floor) {
    constexpr double friction = 0.3;
    Hold hold =
        motion(mover.name + " with friction 0.3 on " + floor.name, "12 at 5 m/s stop after 4.2 m, within 5 %", floor);
    std::vector<Launch> launches;
    for (int k = 0; k < 12; ++k) {
        const SineCosine way = sine_cosine(0.25 * k);
        launches.push_back({{speed * way.cosine, speed * way.sine, 0}, {}});
    }
    add_star(hold.stack, mover, launches, 2.1, friction);
    hold.seconds = 2.75;
    // Friction acts at the ground, so it leans forward by the slop.
    hold.course = [=] {
        return std::make_unique<Slide>(launches, friction * gravity, SlideBounds{.way = 0.05, .speed = 0.02});
    };
    return hold;
}

Hold conveyor(const Mover& mover, const Floor& floor) {
    constexpr double friction = 0.5;
    Hold hold =
        motion(mover.name + " on a conveyor, " + floor.name, "it comes to the belt's 1 m/s after 0.1 m of slip", floor);
    add_star(hold.stack, mover, {Launch{}}, 0, friction);
    hold.seconds = 3.5;
    hold.course = [=] {
        return std::make_unique<Slide>(std::vector<Launch>(1), friction * gravity,
                                       SlideBounds{.way = 0.02, .speed = 0.05}, Vec3{1, 0, 0});
    };
    return hold;
}

} // namespace

std::vector<Hold> slides() {
    std::vector<Hold> all;
    for (const Mover& mover : all_movers())
        for (const Floor& floor : {closed_floor(100, 100), closed_floor(1, 1), open_floor(100, 100)})
            all.push_back(free_slide(mover, floor));
    for (const Mover& mover : {box(), cylinder()})
        for (const Floor& floor :
             {closed_floor(10, 10), closed_floor(1, 100), closed_floor(1, 400), open_floor(1, 1), open_floor(10, 10),
              open_floor(1, 400), uneven_floor(), box_floor(), plane_floor(), height_field_floor()})
            all.push_back(free_slide(mover, floor));
    for (const Mover& mover : {box(), cylinder(), hull(), pebble(), mug_on_its_foot(), bullet_box(), compound()})
        for (const Floor& floor : {closed_floor(100, 100), closed_floor(1, 1)})
            all.push_back(braked_slide(mover, floor));
    for (const Floor& floor : {open_floor(100, 100), uneven_floor(), plane_floor()})
        all.push_back(braked_slide(box(), floor));
    for (const Mover& mover : {box(), cylinder(), bullet_box()})
        for (const Floor& floor : {closed_floor(1, 1), closed_floor(100, 100)}) all.push_back(conveyor(mover, floor));
    return all;
}

} // namespace raycontact::scenes
