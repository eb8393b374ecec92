// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/placing.h>
#include <tests/motion/scenes.h>

namespace raycontact::scenes {

namespace {

/// rise: metres by which one side is higher: bodies go up by no more than that.
Hold crossing(const Mover& mover, const Floor& floor, double rise = 0, double way = 2.5) {
    Hold hold =
        motion(mover.name + " crosses " + floor.name, "12 at 5 m/s in as many directions cross it unmoved", floor);
    const std::vector<Launch> launches = star(5);
    add_star(hold.stack, mover, launches, way / 2, 0, rise);
    hold.seconds = 0.5 + way / 5;
    hold.course = [=] { return std::make_unique<Slide>(launches, 0, SlideBounds{.height = 1e-3 + rise, .turn = 1}); };
    return hold;
}

} // namespace

std::vector<Hold> seams() {
    std::vector<Hold> all;
    const std::vector<Mover> movers{box(),        cylinder(),    pebble(),        capsule_mesh(),
                                    bullet_box(), bullet_ball(), bullet_capsule()};
    for (const Mover& mover : movers)
        for (const Floor& floor : {joined_floor(96, 48), flush_floor(0, 0)}) all.push_back(crossing(mover, floor));
    for (const auto& [left, right] : {std::pair{96U, 90U}, {7U, 96U}, {1U, 96U}, {300U, 7U}})
        for (const Mover& mover : {box(), bullet_ball()}) all.push_back(crossing(mover, joined_floor(left, right)));
    // The slop of a body of 0.2 m is 0.2 mm.
    for (const auto& [gap, rise] : {std::pair{1e-6, 0.0}, {1e-4, 0.0}, {0.0, 1e-5}, {0.0, 1e-4}, {1e-5, 1e-4}})
        for (const Mover& mover : {box(), bullet_ball()}) all.push_back(crossing(mover, flush_floor(gap, rise), rise));
    for (const Mover& mover : {box(), cylinder()}) all.push_back(crossing(mover, flush_floor(0, 0, 48)));
    for (const double uneven : {0.0, 1e-4})
        for (const Mover& mover : {box(), cylinder(), bullet_ball()})
            all.push_back(crossing(mover, tiled_floor(uneven), uneven, 9));
    return all;
}

} // namespace raycontact::scenes
