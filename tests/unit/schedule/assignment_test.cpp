// SPDX-License-Identifier: Apache-2.0
#include "schedule/assignment.h"

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

TEST(Assignment, SharesNewPairsByCostAndKeepsThem) {
    Balance balance(Schedule::sticky, costs);
    Assignment assignment(3);
    std::vector<SlotPair> pairs = chain(100);
    assignment.assign(pairs, balance);
    EXPECT_EQ(assignment.pairs_of(0).size(), 40u);
    EXPECT_EQ(assignment.pairs_of(1).size(), 40u);
    EXPECT_EQ(assignment.pairs_of(2).size(), 20u) << "a pair costs it twice as much";
    std::vector<std::size_t> before;
    for (std::size_t i = 0; i < pairs.size(); ++i) before.push_back(assignment.part_of(i));

    // Every second pair closes; one opens in front of them and one behind.
    std::vector<SlotPair> next{{0, 0}};
    for (std::size_t i = 0; i < pairs.size(); i += 2) next.push_back(pairs[i]);
    next.emplace_back(900, 901);
    assignment.assign(next, balance);
    for (std::size_t i = 0; i < pairs.size(); i += 2) EXPECT_EQ(assignment.part_of(i / 2 + 1), before[i]);
    std::vector<SlotPair> all;
    for (std::size_t part = 0; part < 3; ++part) {
        EXPECT_TRUE(std::ranges::is_sorted(assignment.pairs_of(part)));
        std::ranges::copy(assignment.pairs_of(part), std::back_inserter(all));
    }
    std::ranges::sort(all);
    EXPECT_EQ(all, next);
}

TEST(Assignment, GivesAwayAndMoves) {
    Balance balance(Schedule::sticky, costs);
    Assignment assignment(3);
    const std::vector<SlotPair> pairs = chain(50);
    assignment.assign(pairs, balance);
    const std::vector<SlotPair> of_1(assignment.pairs_of(1).begin(), assignment.pairs_of(1).end());
    balance.drop(1);
    const auto given = assignment.give_away(std::array<std::size_t, 1>{1}, balance);
    EXPECT_EQ(given[0].size() + given[2].size(), of_1.size());
    EXPECT_TRUE(given[1].empty());
    EXPECT_TRUE(std::ranges::is_sorted(given[0]));
    EXPECT_EQ(assignment.pairs_of(1).size(), of_1.size()) << "the lists stay until they are made again";
    assignment.assign(pairs, balance);
    EXPECT_TRUE(assignment.pairs_of(1).empty());

    const std::vector<SlotPair> moving{assignment.pairs_of(0).front(), assignment.pairs_of(0).back()};
    const std::size_t count = assignment.pairs_of(2).size();
    assignment.move(moving, 2);
    assignment.make_lists();
    EXPECT_EQ(assignment.pairs_of(2).size(), count + 2);
    for (const SlotPair& pair : moving) EXPECT_EQ(std::ranges::count(assignment.pairs_of(2), pair), 1);
}

} // namespace
} // namespace raycontact
