// SPDX-License-Identifier: Apache-2.0
#include "schedule/assignment.h"

#include <raycontact/primitives.h>

#include <algorithm>
#include <array>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

constexpr std::array costs{1.0, 1.0, 2.0};

std::vector<SlotPair> chain(BodySlot bodies) {
    std::vector<SlotPair> pairs;
    for (BodySlot i = 0; i < bodies; ++i) pairs.emplace_back(i, i + 1);
    return pairs;
}

class Assignments : public ::testing::Test {
protected:
    Assignments() {
        for (PlacedBody& body : bodies) body.shape = box.get();
    }
    void assign(const std::vector<SlotPair>& pairs) {
        open.step_done();
        assignment.step_done();
        open.set_all(executor, pairs);
        assignment.assign(open, bodies, std::ranges::any_of(bodies, is_ball), balance);
        assignment.ask(executor, open.all(executor));
    }
    std::size_t part_of(const SlotPair& pair) {
        const PairList& all = open.all(executor);
        const auto at = std::ranges::find(all.pairs, pair) - all.pairs.begin();
        return assignment.part_of(all.slots[static_cast<std::size_t>(at)]);
    }
    static bool is_ball(const PlacedBody& body) { return body.shape->round() != nullptr; }
    std::size_t count_on(std::size_t part) const { return assignment.open_on(part).count(); }

    Executor executor{2};
    std::shared_ptr<const Shape> box = make_box({1, 1, 1}), ball = make_ball(1);
    std::vector<PlacedBody> bodies = std::vector<PlacedBody>(1000);
    OpenPairs open;
    Balance balance{Schedule::sticky, costs};
    Assignment assignment{3};
};

TEST_F(Assignments, ShareNewPairsByCostAndKeepThem) {
    const std::vector<SlotPair> pairs = chain(100);
    assign(pairs);
    EXPECT_EQ(count_on(0), 40u);
    EXPECT_EQ(count_on(1), 40u);
    EXPECT_EQ(count_on(2), 20u) << "a pair costs it twice as much";
    std::vector<std::size_t> before;
    for (const SlotPair& pair : pairs) before.push_back(part_of(pair));

    // Every second pair closes; one opens in front of them and one behind.
    std::vector<SlotPair> next{{0, 0}};
    for (std::size_t i = 0; i < pairs.size(); i += 2) next.push_back(pairs[i]);
    next.emplace_back(900, 901);
    assign(next);
    for (std::size_t i = 0; i < pairs.size(); i += 2) EXPECT_EQ(part_of(pairs[i]), before[i]);
    std::vector<SlotPair> all;
    for (std::size_t part = 0; part < 3; ++part) {
        const PairList& asked = assignment.asked_of(part);
        EXPECT_TRUE(std::ranges::is_sorted(asked.pairs));
        EXPECT_EQ(asked.pairs, assignment.all_on(part).pairs);
        for (std::size_t i = 0; i < asked.size(); ++i)
            EXPECT_EQ(assignment.open_on(part)[asked.slots[i]], asked.pairs[i]);
        std::ranges::copy(asked.pairs, std::back_inserter(all));
    }
    std::ranges::sort(all);
    EXPECT_EQ(all, next);
}

TEST_F(Assignments, GiveAwayAndMove) {
    const std::vector<SlotPair> pairs = chain(50);
    assign(pairs);
    const std::vector<SlotPair> of_1 = assignment.all_on(1).pairs;
    balance.drop(1);
    const auto given = assignment.give_away(std::array<std::size_t, 1>{1}, balance);
    EXPECT_EQ(given[0].size() + given[2].size(), of_1.size());
    EXPECT_EQ(given[1].size(), 0u);
    EXPECT_TRUE(std::ranges::is_sorted(given[0].pairs));
    for (std::size_t i = 0; i < given[0].size(); ++i)
        EXPECT_EQ(assignment.open_on(0)[given[0].slots[i]], given[0].pairs[i]);
    EXPECT_EQ(count_on(1), 0u);
    assign(pairs);
    EXPECT_EQ(count_on(1), 0u);

    const PairList all = assignment.all_on(0);
    PairList moving;
    for (const std::size_t i : {std::size_t{0}, all.size() - 1}) moving.add({all.pairs[i], all.slots[i]});
    const std::size_t count = count_on(2);
    assignment.move(moving, 0, 2);
    EXPECT_EQ(count_on(2), count + 2);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(assignment.open_on(2)[moving.slots[i]], moving.pairs[i]);
        EXPECT_EQ(part_of(moving.pairs[i]), 2u);
    }
}

// What the first part knows of its pairs goes by their slots, which stay when others come beside it.
TEST_F(Assignments, AddAPartBesideTheOnlyOne) {
    assignment = Assignment(1);
    balance.drop(2); // there are two at most
    assign(chain(20));
    const PairList all = open.all(executor);
    assignment.add_part();
    assignment.ask(executor, open.all(executor));
    EXPECT_EQ(assignment.asked_of(0).slots, all.slots);
    EXPECT_EQ(assignment.open_on(0).changes().now(), open.slots().changes().now());
    EXPECT_EQ(count_on(1), 0u);
    assign(chain(25));
    EXPECT_EQ(count_on(0) + count_on(1), 25u);
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(part_of(all.pairs[i]), 0u);
}

// The first round body divides what the one part had by the slots of the scene; those stay for what it knows.
TEST_F(Assignments, LeavePairsOfRoundBodiesOut) {
    assignment = Assignment(1);
    for (const std::size_t part : {1, 2}) balance.drop(part);
    assign(chain(20));
    const PairList all = open.all(executor);
    bodies[22].shape = ball.get();
    assign(chain(25));
    EXPECT_EQ(count_on(0), 23u) << "22 is in two";
    const PairList& asked = assignment.asked_of(0);
    EXPECT_EQ(asked.pairs, assignment.all_on(0).pairs);
    ASSERT_EQ(asked.size(), 23u);
    for (std::size_t i = 0; i < asked.size(); ++i) {
        EXPECT_FALSE(asked.pairs[i].first == 22 || asked.pairs[i].second == 22);
        if (i < all.size()) {
            EXPECT_EQ(asked.slots[i], all.slots[i]);
        }
    }
    EXPECT_EQ(part_of({21, 22}), 0u);
    assignment.forget();
    assign(chain(25));
    EXPECT_EQ(count_on(0), 23u) << "what begins anew leaves them out, too";
}

} // namespace
} // namespace raycontact
