// SPDX-License-Identifier: Apache-2.0
#include "schedule/balance.h"
#include "schedule/moving_pairs.h"

#include <array>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

constexpr std::array costs{1.0, 1.0};

void step(Balance& balance, double load_0, double ms_0, double load_1, double ms_1) {
    balance.record(0, load_0, ms_0);
    balance.record(1, load_1, ms_1);
    balance.end_step(100);
}

TEST(Balance, MovesAfterEightUnevenSteps) {
    Balance balance(Schedule::counted, costs);
    for (int i = 0; i < 7; ++i) step(balance, 300, 0, 100, 0);
    EXPECT_FALSE(balance.next_move()) << "7 steps";
    step(balance, 200, 0, 200, 0);
    for (int i = 0; i < 7; ++i) step(balance, 300, 0, 100, 0);
    EXPECT_FALSE(balance.next_move()) << "an even step between";
    step(balance, 300, 0, 100, 0);
    const auto move = balance.next_move();
    ASSERT_TRUE(move);
    EXPECT_EQ(move->from, 0u);
    EXPECT_EQ(move->to, 1u);
    EXPECT_DOUBLE_EQ(move->share, 1.0 / 3) << "100 of 300: then both have 200";
    balance.record_move(*move, 1);
    EXPECT_FALSE(balance.next_move()) << "both have 200 now";
    for (int i = 0; i < 8; ++i) {
        step(balance, 300, 0, 100, 0);
        EXPECT_FALSE(balance.next_move()) << "it waits again";
    }
    step(balance, 300, 0, 100, 0);
    EXPECT_TRUE(balance.next_move());
}

// Two parts that have too much and two that have too little: three moves at most.
TEST(Balance, LevelsAllPartsInOneStep) {
    Balance balance(Schedule::counted, std::array{1.0, 1.0, 1.0, 1.0});
    std::array loads{400.0, 300.0, 60.0, 40.0};
    for (int i = 0; i < 8; ++i) {
        for (std::size_t part = 0; part < 4; ++part) balance.record(part, loads[part], 0);
        balance.end_step(100);
    }
    int moves = 0;
    while (const auto move = balance.next_move()) {
        const double load = move->share * loads[move->from];
        loads[move->from] -= load;
        loads[move->to] += load;
        balance.record_move(*move, 0);
        ASSERT_LE(++moves, 3);
    }
    for (const double load : loads) EXPECT_NEAR(load, 200, 20);
}

TEST(Balance, StickyNeverMovesAndLittleIsEven) {
    Balance sticky(Schedule::sticky, costs), counted(Schedule::counted, costs);
    for (int i = 0; i < 30; ++i) {
        step(sticky, 300, 0, 100, 0);
        step(counted, 109, 0, 91, 0);
    }
    EXPECT_FALSE(sticky.next_move());
    EXPECT_FALSE(counted.next_move());
}

// A device that takes three times as long for a unit gets a quarter of the pairs.
TEST(Balance, GoesByWhatAUnitWasMeasuredToCost) {
    Balance balance(Schedule::balanced, costs);
    for (int i = 0; i < 8; ++i) step(balance, 100, 1, 100, 3);
    const auto move = balance.next_move();
    ASSERT_TRUE(move);
    EXPECT_EQ(move->from, 1u);
    EXPECT_NEAR(move->share, 1.0 / 3, 1e-9) << "of 3 ms against 1 ms, to their mean of 2 ms";
    step(balance, 0, 0, 0, 0); // no pairs: no cost is measured
    int slow = 0;
    for (int i = 0; i < 100; ++i) slow += balance.part_for_new_pair() == 1 ? 1 : 0;
    EXPECT_EQ(slow, 25);
}

TEST(Balance, DoesNotMoveWhatCostsMoreThanItGains) {
    Balance balance(Schedule::balanced, costs);
    const auto uneven = [&] {
        for (int i = 0; i < 8; ++i) step(balance, 300, 3, 100, 1);
    };
    uneven();
    const auto move = balance.next_move();
    ASSERT_TRUE(move);
    balance.record_move(*move, 1000); // 10 ms a unit, which costs 0.01 ms a step
    uneven();
    EXPECT_FALSE(balance.next_move());
}

TEST(Balance, DropsAPart) {
    Balance balance(Schedule::counted, costs);
    balance.drop(0);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(balance.part_for_new_pair(), 1u);
    for (int i = 0; i < 20; ++i) {
        balance.record(1, 100, 1);
        balance.end_step(100);
    }
    EXPECT_FALSE(balance.next_move()) << "nowhere to go";
}

TEST(MovingPairs, AreThoseOfTheBodiesWithLeastToCarry) {
    // Body 0 touches all others; body 5 has the most contacts.
    const PairList pairs{{{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}, {4, 5}}, {9, 8, 7, 6, 5, 4}};
    std::vector<Contact> contacts(12);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        contacts[i].body_a = {i < 4 ? 0u : 4u};
        contacts[i].body_b = {5};
    }
    // 18 in all: {0, 5} weighs 5, {4, 5} 9, the others 1 each.
    const MovingPairs some = choose_moving(pairs, contacts, 0.12);
    EXPECT_EQ(some.pairs.pairs, (std::vector<SlotPair>{{0, 1}, {0, 2}}));
    EXPECT_EQ(some.pairs.slots, (std::vector<std::uint32_t>{9, 8}));
    EXPECT_DOUBLE_EQ(some.share, 2.0 / 18);
    EXPECT_TRUE(choose_moving(pairs, contacts, 0).pairs.pairs.empty());
    EXPECT_EQ(choose_moving({}, {}, 0.5).share, 0);
}

} // namespace
} // namespace raycontact
