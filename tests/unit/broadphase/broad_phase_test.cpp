// SPDX-License-Identifier: Apache-2.0
#include "broadphase/broad_phase.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace raycontact {
namespace {

bool overlap(const WorldBox& a, const WorldBox& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y
           && a.low.z <= b.high.z && b.low.z <= a.high.z;
}

std::vector<SlotPair> all_pairs(const std::vector<WorldBox>& boxes) {
    std::vector<SlotPair> pairs;
    for (const WorldBox& a : boxes)
        for (const WorldBox& b : boxes)
            if (a.body < b.body && overlap(a, b)) pairs.emplace_back(a.body, b.body);
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

TEST(BroadPhase, AgreesWithEveryPairTested) {
    std::mt19937 random(5);
    std::size_t found = 0;
    for (int round = 0; round < 60; ++round) {
        // Integer corners, so that many boxes only touch.
        std::uniform_int_distribution<int> place(0, round % 2 ? 40 : 8), size(0, 4);
        std::vector<WorldBox> boxes;
        for (BodySlot body = 0; body < 80; ++body) {
            const Vec3 low{double(place(random)), double(place(random)), double(round % 3 ? place(random) : 0)};
            boxes.push_back({{low, {low.x + size(random), low.y + size(random), low.z + size(random)}}, body});
        }
        const std::vector<SlotPair> expected = all_pairs(boxes);
        std::vector<SlotPair> pairs, again;
        Executor executor(1);
        BroadPhase().find(executor, boxes, pairs);
        EXPECT_EQ(pairs, expected);
        std::shuffle(boxes.begin(), boxes.end(), random);
        BroadPhase().find(executor, boxes, again);
        EXPECT_EQ(again, expected) << "the order of the bodies decides nothing";
        found += pairs.size();
    }
    EXPECT_GT(found, 5000u);
}

// Trees of several levels; boxes that move far, come and go, beside one that holds nearly all.
TEST(BroadPhase, AgreesWithEveryPairTestedWhileBoxesMove) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(0, 1);
    Executor one(1), four(4);
    for (const double far : {0.0, 3e7, 1e12}) {
        std::vector<WorldBox> boxes;
        const auto move = [&](WorldBox& box, double side) {
            const Vec3 low{far + side * any(random), side * any(random), side * any(random)};
            box.low = low;
            box.high = low + Vec3{any(random), any(random), any(random)};
        };
        for (BodySlot body = 0; body < 2500; ++body) move(boxes.emplace_back(WorldBox{{}, body}), 20);
        boxes.push_back({{{far, 0, 0}, {far + 15, 15, 1}}, 2500});
        BroadPhase kept, of_four;
        std::vector<SlotPair> pairs, again;
        for (int step = 0; step < 12; ++step) {
            // A few, then all, into a corner, and back.
            for (std::size_t i = 0; i + 1 < boxes.size(); i += step < 4 ? 50 : 1)
                move(boxes[i], step % 3 == 1 ? 5 : 20);
            if (step % 4 == 3) boxes.erase(boxes.begin() + 7 * step);
            const std::vector<SlotPair> expected = all_pairs(boxes);
            ASSERT_GT(expected.size(), 300u);
            kept.find(one, boxes, pairs);
            ASSERT_EQ(pairs, expected) << "step " << step;
            of_four.find(four, boxes, again);
            ASSERT_EQ(again, expected) << "step " << step;
        }
    }
}

TEST(BroadPhase, OneBoxOrNoneHasNoPair) {
    Executor executor(1);
    BroadPhase broad_phase;
    std::vector<SlotPair> pairs{{1, 2}};
    broad_phase.find(executor, {}, pairs);
    EXPECT_TRUE(pairs.empty());
    const std::vector<WorldBox> boxes(1, WorldBox{{{0, 0, 0}, {1, 1, 1}}, 3});
    broad_phase.find(executor, boxes, pairs);
    EXPECT_TRUE(pairs.empty());
    const std::vector<WorldBox> alike{boxes[0], WorldBox{boxes[0], 1}, WorldBox{boxes[0], 9}};
    broad_phase.find(executor, alike, pairs);
    EXPECT_EQ(pairs, (std::vector<SlotPair>{{1, 3}, {1, 9}, {3, 9}}));
}

TEST(WorldBox, HoldsTheTurnedBox) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int round = 0; round < 1000; ++round) {
        const Pose pose = pose_from_quaternion({1e4 * any(random), any(random), any(random)}, any(random), any(random),
                                               any(random), any(random));
        const Vec3 low{-1, -0.2, 0.3}, high{0.5, 0.1, 2};
        const Box box = world_box({low, high}, pose, 0);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 p = transform_point(
                pose, {corner & 1 ? low.x : high.x, corner & 2 ? low.y : high.y, corner & 4 ? low.z : high.z});
            ASSERT_TRUE(box.touches({p, p}));
        }
    }
}

// The narrow phase looks for vertices in the widened box of the body frame: its corners count too.
TEST(WorldBox, HoldsTheCornersOfTheWidenedBox) {
    const Pose pose = pose_from_quaternion({1, 2, 3}, 0.9, 0.2, -0.3, 0.25);
    const double grow = 0.7;
    const Box box = world_box({{-1, -2, -3}, {1, 2, 3}}, pose, grow);
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner{(i & 1 ? 1 : -1) * (1 + grow), (i & 2 ? 1 : -1) * (2 + grow), (i & 4 ? 1 : -1) * (3 + grow)};
        const Vec3 p = transform_point(pose, corner);
        EXPECT_TRUE(p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y && p.z >= box.low.z
                    && p.z <= box.high.z)
            << "corner " << i;
    }
}

} // namespace
} // namespace raycontact
