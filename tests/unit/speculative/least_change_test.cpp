// SPDX-License-Identifier: Apache-2.0
// A cube that has sunk into a tile and come past its side: by hand.
#include <raycontact/least_change.h>

#include <raycontact/collide.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace raycontact {
namespace {

using namespace reference;

struct Slide {
    std::shared_ptr<const Shape> cube = Shape::make(box_mesh({0.5, 0.5, 0.5})),
                                 tile = Shape::make(box_mesh({2, 2, 0.5}));
    Pose pose_of_cube;

    /// The cube's front has come `past` beyond the tile's side at x = -2, and is `sunk` below its top.
    Slide(double past, double sunk) { pose_of_cube.translation = {-2.5 + past, 0.1, 1 - sunk}; }
    std::vector<Contact> contacts() const { return collide(*cube, pose_of_cube, *tile, {}); }
    Contact changed(const Contact& contact, double way, double margin = 0.002) const {
        Pose next = pose_of_cube;
        next.translation.x += way;
        return least_change(contact, {*cube, pose_of_cube, next}, {*tile, {}, {}}, margin);
    }
};

TEST(LeastChange, WhatSlidesOntoATileLeavesUpwards) {
    const Slide slide(0.0002, 0.0003);
    std::size_t sideways = 0;
    for (const Contact& contact : slide.contacts()) {
        if (contact.feature.kind != FeatureKind::vertex || std::abs(contact.normal.x) < 0.9f) continue;
        ++sideways;
        const Contact changed = slide.changed(contact, 0.08);
        EXPECT_NEAR(double(changed.normal.z), -1, 1e-6);
        EXPECT_NEAR(double(changed.depth), 0.0003, 1e-6);
        EXPECT_NEAR(changed.point_a.z - changed.point_b.z, -0.0003, 1e-6);
        EXPECT_EQ(changed.key(), contact.key());
        const Contact rests = slide.changed(contact, 0), wide = slide.changed(contact, 0.08, 1e-4);
        EXPECT_EQ(rests.normal.x, contact.normal.x) << "it does not move";
        EXPECT_EQ(wide.normal.x, contact.normal.x) << "deeper than the margin";
    }
    EXPECT_GE(sideways, 1u);
}

TEST(LeastChange, AStepHigherThanTheMarginIsAWall) {
    const Slide slide(0.0002, 0.01);
    std::size_t sideways = 0;
    for (const Contact& contact : slide.contacts()) {
        if (std::abs(contact.normal.x) < 0.9f) continue;
        ++sideways;
        EXPECT_EQ(slide.changed(contact, 0.08).normal.x, contact.normal.x);
    }
    EXPECT_GE(sideways, 1u);
}

TEST(LeastChange, WhatLeavesARimIsStillHeld) {
    Slide slide(0, 0.0003);
    slide.pose_of_cube.translation.x = 2 - 0.5 - 1e-6; // its front is at the far side, and goes beyond
    for (const Contact& contact : slide.contacts()) {
        if (contact.normal.z > -0.9f) continue;
        EXPECT_EQ(slide.changed(contact, 0.01).normal.z, contact.normal.z);
    }
}

} // namespace
} // namespace raycontact
