// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <scenes/models/machined.h>
#include <scenes/models/simplify.h>

#include <gtest/gtest.h>

using namespace raycontact;

TEST(Machined, BoltAndNutAreSoundAndDoNotTouch) {
    const scenes::Thread thread;
    const auto bolt = Shape::make(prepare_mesh(scenes::threaded_bolt(thread), {.repair = Repair::as_is}));
    const auto nut = Shape::make(prepare_mesh(scenes::threaded_nut(thread), {.repair = Repair::as_is}));
    for (const auto& shape : {bolt, nut}) {
        EXPECT_TRUE(scenes::sound(shape->report())) << to_text(shape->report());
        EXPECT_GT(shape->report().volume, 0);
    }
    // A turn is a pitch of the thread.
    for (const double turns : {4, 5}) {
        EXPECT_FALSE(intersects(*bolt, {}, *nut, {.translation = {0, 0, turns * thread.pitch}})) << turns;
        // By a third of a turn without turning: flank meets flank.
        EXPECT_TRUE(intersects(*bolt, {}, *nut, {.translation = {0, 0, (turns + 1.0 / 3) * thread.pitch}})) << turns;
    }
}
