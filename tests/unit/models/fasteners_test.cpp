// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <scenes/models/cache.h>
#include <scenes/models/fasteners.h>
#include <scenes/models/simplify.h>

#include <gtest/gtest.h>

using namespace raycontact;

TEST(Fasteners, AreSoundAndDoNotTouch) {
    const auto bolt = Shape::make(prepare_mesh(scenes::bolt(), Repair::as_is));
    const auto nut = Shape::make(prepare_mesh(scenes::nut(), Repair::as_is));
    for (const auto& shape : {bolt, nut}) {
        EXPECT_TRUE(scenes::sound(shape->report())) << to_text(shape->report());
        EXPECT_GT(shape->report().volume, 0);
    }
    EXPECT_FALSE(intersects(*bolt, {}, *nut, {}));
    // By a twelfth of a turn without going along: flank meets flank.
    EXPECT_TRUE(intersects(*bolt, {}, *nut, {.translation = {0, 0, 0.0008}}));
    // A turn is a pitch of the thread.
    EXPECT_FALSE(intersects(*bolt, {}, *nut, {.translation = {0, 0, 0.003}}));
}
