// SPDX-License-Identifier: Apache-2.0
#include "pairs/open_pairs.h"
#include "pairs/pair_table.h"
#include "pairs/range_pool.h"

#include "reference/random.h"

#include <raycontact/error.h>

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace raycontact {
namespace {

using reference::Random;

struct Hot {
    double left = -1;
};

struct State {
    double mark = 0;
    int untouched = 7;
};

// Pairs of so many bodies, of which some stay from step to step.
void keep_pairs(BodySlot bodies, std::uint32_t most, int steps) {
    Random random(1);
    Executor executor(2);
    OpenPairs open;
    PairTable<State, Hot> table;
    std::map<SlotPair, double> model; // a mark for each open pair
    double mark = 0;
    std::uint64_t most_bytes = 0;
    for (int step = 0; step < steps; ++step) {
        std::set<SlotPair> wanted;
        const std::uint32_t count = step % 50 == steps % 50 ? 0 : random.below(most);
        if (step % 3 == 0)
            for (const auto& [pair, its_mark] : model)
                if (random.below(50) > 0) wanted.insert(pair);
        for (std::uint32_t i = 0; i < count; ++i) {
            const BodySlot a = random.below(bodies);
            wanted.insert({a, a + 1 + random.below(6)});
        }
        const std::vector<SlotPair> pairs(wanted.begin(), wanted.end());
        std::multiset<double> closed, expected;
        for (const auto& [pair, its_mark] : model)
            if (!wanted.contains(pair)) expected.insert(its_mark);
        open.set_all(executor, pairs);
        EXPECT_EQ(table.knows(open.slots()), step > 0);
        table.begin(open.slots(), open.all(executor).slots, [&](State& state) {
            if (state.mark != 0) closed.insert(state.mark);
        });
        open.step_done();
        ASSERT_EQ(closed, expected);
        std::map<SlotPair, double> next;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            State& state = table.state(i);
            if (const auto found = model.find(pairs[i]); found != model.end()) {
                ASSERT_EQ(state.mark, found->second);
                ASSERT_EQ(table.hot(i).left, found->second);
            } else {
                ASSERT_EQ(state.mark, 0.0);
                ASSERT_EQ(state.untouched, 7) << "a new pair begins afresh";
                ASSERT_LT(table.hot(i).left, 0.0);
                state.mark = table.hot(i).left = ++mark;
                state.untouched = 1;
            }
            next[pairs[i]] = state.mark;
        }
        model.swap(next);
        if (pairs.empty()) {
            EXPECT_EQ(table.bytes(), 0u);
        }
        EXPECT_LE(table.bytes(), 64 * pairs.size());
        most_bytes = std::max(most_bytes, table.bytes());
    }
    EXPECT_GT(most_bytes, 0u);
    table.clear();
    EXPECT_EQ(table.bytes(), 0u);
    bool closed = false;
    const std::vector<SlotPair> one{{0, 1}};
    open.set_all(executor, one);
    table.begin(open.slots(), open.all(executor).slots, [&](State&) { closed = true; });
    EXPECT_FALSE(closed) << "what was cleared is not open any more";
    EXPECT_EQ(table.state(0).mark, 0.0);
}

TEST(PairTable, KeepsThePairsThatStayAndTellsOfThoseThatGo) {
    keep_pairs(12, 60, 400);
    keep_pairs(20'000, 12'000, 8); // many slices
}

TEST(PairTable, AsksOfThePairsThatWantItInTheirOrder) {
    Executor executor(1);
    PairTable<State, Hot> table;
    std::vector<SlotPair> pairs;
    for (BodySlot i = 0; i < 500; ++i) pairs.emplace_back(i, i + 1);
    OpenPairs open;
    open.set_all(executor, pairs);
    table.begin(open.slots(), open.all(executor).slots, [](State&) {});
    Random random(3);
    std::vector<bool> wanted(pairs.size());
    for (auto&& one : wanted) one = random.below(3) == 0;
    for (const auto& [begin, end] : {SlotPair{0, 500}, SlotPair{7, 130}, SlotPair{499, 500}, SlotPair{40, 40}}) {
        std::vector<std::uint32_t> asked, expected;
        std::vector<int> sent_for(pairs.size()), looked_at(pairs.size());
        for (std::uint32_t i = begin; i < end; ++i)
            if (wanted[i]) expected.push_back(i);
        table.sift(
            begin, end, [&](std::uint32_t i) { ++sent_for[i]; },
            [&](std::uint32_t i, Hot& hot) {
                EXPECT_EQ(&hot, &table.hot(i));
                EXPECT_EQ(sent_for[i], 1);
                ++looked_at[i];
                return bool(wanted[i]);
            },
            [&](std::uint32_t i) { asked.push_back(i); });
        EXPECT_EQ(asked, expected);
        for (std::uint32_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(looked_at[i], i >= begin && i < end ? 1 : 0);
    }
}

TEST(RangePool, RangesNeverOverlapAndAreUsedAgain) {
    Random random(2);
    RangePool pool;
    std::map<std::uint32_t, RangePool::Range> out; // by their first element
    std::uint64_t elements = 0, most = 0;
    for (int i = 0; i < 20000; ++i) {
        if (out.size() > 40 || (!out.empty() && random.below(2))) {
            auto it = out.begin();
            std::advance(it, random.below(static_cast<std::uint32_t>(out.size())));
            elements -= it->second.capacity;
            pool.release(it->second);
            out.erase(it);
        } else {
            const std::uint32_t count = 1 + random.below(1u << random.below(10));
            const RangePool::Range range = pool.allocate(count);
            ASSERT_GE(range.capacity, count);
            ASSERT_LE(range.capacity, std::max(4u, 2 * count));
            ASSERT_LE(range.first + range.capacity, pool.end());
            const auto after = out.lower_bound(range.first);
            if (after != out.end()) {
                ASSERT_LE(range.first + range.capacity, after->first);
            }
            if (after != out.begin()) {
                const RangePool::Range before = std::prev(after)->second;
                ASSERT_LE(before.first + before.capacity, range.first);
            }
            out[range.first] = range;
            elements += range.capacity;
            most = std::max(most, elements);
        }
        ASSERT_EQ(pool.in_use(), elements);
    }
    EXPECT_LE(pool.end(), 12 * most) << "a range given back fits the next of its size";
    pool.clear();
    EXPECT_EQ(pool.end(), 0u);
    EXPECT_EQ(pool.in_use(), 0u);
}

TEST(RangePool, GivesNothingForNothingAndRefusesTooMuch) {
    RangePool pool;
    EXPECT_EQ(pool.allocate(0).capacity, 0u);
    pool.release({});
    EXPECT_EQ(pool.end(), 0u);
    EXPECT_THROW(pool.allocate((1u << 30) + 1), InputError);
    EXPECT_EQ(pool.allocate(1u << 30).capacity, 1u << 30);
    EXPECT_EQ(pool.allocate(1u << 30).capacity, 1u << 30);
    EXPECT_THROW(pool.allocate(1), InputError);
    EXPECT_EQ(pool.in_use(), 1ull << 31) << "a refusal changes nothing";
}

// What another table kept goes to the pair that has it now, if that is still open.
TEST(PairTable, TakesWhatAnotherKept) {
    PairSlots open;
    PairTable<State, Hot> table;
    const auto ignore = [](State&) {};
    const std::uint32_t first = open.open({1, 2}), gone = open.open({3, 4});
    table.import_state({1, 2}, first, {5, 1}, {6});
    table.import_state({3, 4}, gone, {7, 1}, {8});
    open.close(gone);
    EXPECT_EQ(open.open({7, 8}), gone);
    EXPECT_FALSE(table.knows(open, first)) << "before the table has begun";
    const std::uint32_t slots[] = {first, gone};
    table.begin(open, slots, ignore);
    EXPECT_EQ(table.state(0).mark, 5);
    EXPECT_EQ(table.hot(0).left, 6);
    EXPECT_EQ(table.state(1).mark, 0);
    open.step_done();
    EXPECT_TRUE(table.knows(open, first));
    open.close(gone);
    const std::uint32_t next = open.open({3, 4});
    EXPECT_EQ(next, gone);
    EXPECT_TRUE(table.knows(open, first));
    EXPECT_FALSE(table.knows(open, next));
    open.forget();
    table.begin(open, slots, ignore);
    EXPECT_EQ(table.state(0).mark, 0) << "what has missed a step begins afresh";
}

} // namespace
} // namespace raycontact
