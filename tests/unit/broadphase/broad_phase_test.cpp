// SPDX-License-Identifier: Apache-2.0
#include "broadphase/broad_phase.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <random>
#include <utility>

namespace raycontact {
namespace {

using Filter = BroadPhaseInput::Filter;

bool overlap(const Box& a, const Box& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y
           && a.low.z <= b.high.z && b.low.z <= a.high.z;
}

std::vector<SlotPair> all_pairs(const std::vector<Box>& boxes, const std::vector<Filter>& filters = {}) {
    std::vector<SlotPair> pairs;
    for (BodySlot a = 0; a < boxes.size(); ++a)
        for (BodySlot b = a + 1; b < boxes.size(); ++b)
            if (overlap(boxes[a], boxes[b])
                && (filters.empty()
                    || ((filters[a].groups & filters[b].mask) != 0 && (filters[b].groups & filters[a].mask) != 0
                        && !(filters[a].is_static && filters[b].is_static))))
                pairs.emplace_back(a, b);
    return pairs;
}

/// With the tree that it needs.
struct Finder {
    BoxTree tree;
    BroadPhase broad_phase;
    OpenPairs open;
    void find(Executor& executor, const BroadPhaseInput& input, std::vector<SlotPair>& pairs) {
        tree.build(executor, input.boxes);
        const std::span<const SlotPair> found = broad_phase.find(executor, tree, input);
        pairs.assign(found.begin(), found.end());
        open.set_all(executor, found);
    }
    // Whether the pairs are others.
    bool update(Executor& executor, const BroadPhaseInput& input, std::span<const BodySlot> changed,
                std::vector<SlotPair>& pairs) {
        tree.update(executor, input.boxes, changed);
        open.step_done();
        broad_phase.update(executor, tree, input, changed, open);
        pairs = open.all(executor).pairs;
        return open.have_changed();
    }
};

TEST(BroadPhase, AgreesWithEveryPairTested) {
    std::mt19937 random(5);
    std::size_t found = 0;
    for (int round = 0; round < 60; ++round) {
        // Integer corners, so that many boxes only touch.
        std::uniform_int_distribution<int> place(0, round % 2 ? 40 : 8), size(0, 4);
        std::vector<Box> boxes;
        for (BodySlot body = 0; body < 80; ++body) {
            const Vec3 low{double(place(random)), double(place(random)), double(round % 3 ? place(random) : 0)};
            boxes.push_back({low, {low.x + size(random), low.y + size(random), low.z + size(random)}});
        }
        if (round % 5 == 0) boxes[7] = boxes[0] = no_box;
        std::vector<SlotPair> pairs;
        Executor executor(1);
        Finder().find(executor, {boxes, {}}, pairs);
        EXPECT_EQ(pairs, all_pairs(boxes));
        found += pairs.size();
    }
    EXPECT_GT(found, 5000u);
}

// Trees of several levels; boxes that move far, come and go, beside one that holds nearly all. update() is told of the
// few or the many that moved, and says whether the pairs are others.
TEST(BroadPhase, AgreesWithEveryPairTestedWhileBoxesMove) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(0, 1);
    Executor one(1), four(4);
    std::size_t same = 0, others = 0;
    for (const double far : {0.0, 3e7, 1e12}) {
        std::vector<Box> boxes;
        std::vector<Filter> filters(2501);
        for (std::size_t i = 0; i < 2501; i += 9) filters[i] = {2, i % 2 ? 1u : 3u};
        for (std::size_t i = 0; i < 2501; i += 5) filters[i].is_static = true;
        const auto move = [&](Box& box, double side) {
            const Vec3 low{far + side * any(random), side * any(random), side * any(random)};
            box = {low, low + Vec3{any(random), any(random), any(random)}};
        };
        for (BodySlot body = 0; body < 2500; ++body) move(boxes.emplace_back(), 20);
        boxes.push_back({{far, 0, 0}, {far + 15, 15, 1}});
        Finder kept, of_four, told;
        std::vector<SlotPair> pairs, again, of_told;
        told.find(one, {boxes, filters}, of_told);
        std::vector<SlotPair> expected = all_pairs(boxes, filters);
        for (int step = 0; step < 24; ++step) {
            std::vector<BodySlot> changed;
            const auto change = [&](std::size_t i) { changed.push_back(static_cast<BodySlot>(i)); };
            if (step % 6 == 5) { // hardly
                boxes[11].high.x += 1e-9;
                change(11);
            } else { // a few, then all, into a corner, and back
                for (std::size_t i = 0; i + 1 < boxes.size(); i += step % 8 < 4 ? 50 : 1) {
                    move(boxes[i], step % 3 == 1 ? 5 : 20);
                    change(i);
                }
            }
            if (step % 4 == 3) {
                boxes[7 * step + 1] = no_box;
                if (changed.size() < 100) change(7 * step + 1);
            }
            const std::vector<SlotPair> before = std::exchange(expected, all_pairs(boxes, filters));
            ASSERT_GT(expected.size(), 300u);
            kept.find(one, {boxes, filters}, pairs);
            ASSERT_EQ(pairs, expected) << "step " << step;
            of_four.find(four, {boxes, filters}, again);
            ASSERT_EQ(again, expected) << "step " << step;
            ASSERT_EQ(told.update(step % 2 ? four : one, {boxes, filters}, changed, of_told), before != expected);
            ASSERT_EQ(of_told, expected) << "step " << step;
            (before == expected ? same : others) += 1;
        }
    }
    EXPECT_GT(same, 5u);
    EXPECT_GT(others, 30u);
}

TEST(BroadPhase, OneBoxOrNoneHasNoPair) {
    Executor executor(1);
    Finder broad_phase;
    std::vector<SlotPair> pairs{{1, 2}};
    broad_phase.find(executor, {}, pairs);
    EXPECT_TRUE(pairs.empty());
    std::vector<Box> boxes{{{0, 0, 0}, {1, 1, 1}}};
    broad_phase.find(executor, {boxes, {}}, pairs);
    EXPECT_TRUE(pairs.empty());
    boxes.resize(4, boxes[0]);
    boxes[1] = no_box;
    EXPECT_TRUE(broad_phase.update(executor, {boxes, {}}, std::array<BodySlot, 3>{3, 2, 1}, pairs));
    EXPECT_EQ(pairs, (std::vector<SlotPair>{{0, 2}, {0, 3}, {2, 3}}));
    EXPECT_FALSE(broad_phase.update(executor, {boxes, {}}, {}, pairs));
}

// They touch no lane without a box.
TEST(BroadPhase, BoxesMayReachBeyondAllFloats) {
    std::vector<Box> boxes(19, {{0, 0, 0}, {1, 1, 1}});
    boxes[3] = {{-1e45, -1e45, 1e60}, {1e45, 1e45, 1e61}};
    boxes[5] = {{-1e45, -1e45, -1e45}, {1e45, 1e45, 1e45}};
    boxes[7] = no_box;
    std::vector<SlotPair> pairs;
    Executor executor(1);
    Finder().find(executor, {boxes, {}}, pairs);
    EXPECT_EQ(pairs, all_pairs(boxes));
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

TEST(PairSorter, SortsListsInAnyOrder) {
    std::mt19937 random(9);
    for (const std::uint32_t threads : {1u, 3u}) {
        Executor executor(threads);
        PairSorter<SlotPair> sorter;
        for (const std::size_t count : {0u, 1u, 200u, 60000u}) {
            constexpr BodySlot bodies = 700;
            std::uniform_int_distribution<BodySlot> body(0, bodies - 1);
            std::vector<SlotPair> pairs, expected, sorted;
            for (std::size_t i = 0; i < count; ++i) pairs.push_back(std::minmax(body(random), body(random)));
            expected = pairs;
            std::sort(expected.begin(), expected.end());
            sorter.run(executor, bodies, pairs, sorted);
            EXPECT_EQ(sorted, expected);
            const std::span<const SlotPair> all(pairs);
            const std::array lists{all.first(count / 3), all.subspan(count / 3)};
            sorter.run(executor, bodies, lists, sorted);
            EXPECT_EQ(sorted, expected);
        }
    }
}

// Many slices of the list, some without a change.
TEST(BroadPhase, PutsWhatChangedIntoALongList) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(0, 30), step(-0.5, 0.5);
    constexpr BodySlot count = 4000;
    std::vector<Box> boxes;
    for (BodySlot body = 0; body < count; ++body) {
        const Vec3 low{place(random), place(random), 0};
        boxes.push_back({low, {low.x + 2, low.y + 2, 1}});
    }
    for (const std::uint32_t threads : {1u, 3u}) {
        Executor executor(threads);
        Finder finder;
        std::vector<SlotPair> pairs, expected;
        finder.find(executor, {boxes, {}}, pairs);
        EXPECT_GT(pairs.size(), 5 * 4096u);
        for (int round = 0; round < 5; ++round) {
            std::vector<BodySlot> changed;
            for (BodySlot body = round == 0 ? 3990 : 0; body < count; body += round == 0 ? 1 : 17) {
                const Vec3 by{step(random), step(random), round == 3 ? 5.0 : 0.0};
                boxes[body] = {boxes[body].low + by, boxes[body].high + by};
                changed.push_back(body);
            }
            EXPECT_TRUE(finder.update(executor, {boxes, {}}, changed, pairs));
            Finder().find(executor, {boxes, {}}, expected);
            ASSERT_EQ(pairs, expected);
        }
        EXPECT_FALSE(finder.update(executor, {boxes, {}}, std::vector<BodySlot>{1, 5, 3000}, pairs));
        EXPECT_EQ(pairs, expected);
    }
}

} // namespace
} // namespace raycontact
