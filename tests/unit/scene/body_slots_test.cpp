// SPDX-License-Identifier: Apache-2.0
#include "body_slots.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace raycontact {
namespace {

BodyId add(BodySlots& slots) {
    const BodyId next = slots.next(), given = slots.give();
    EXPECT_EQ(given, next);
    return given;
}

TEST(BodySlots, IdsCountUpFromZero) {
    BodySlots slots;
    for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(add(slots), BodyId{i});
    EXPECT_EQ(slots.count(), 100u);
    EXPECT_EQ(slots.end(), 100u);
}

TEST(BodySlots, TheLowestFreeSlotIsGiven) {
    BodySlots slots;
    for (int i = 0; i < 6; ++i) add(slots);
    for (const BodySlot slot : {4u, 1u, 3u}) slots.take_back(slot); // no step has seen them
    EXPECT_EQ(add(slots), (BodyId{1, 1}));
    EXPECT_EQ(add(slots), (BodyId{3, 1}));
    EXPECT_EQ(add(slots), (BodyId{4, 1}));
    EXPECT_EQ(add(slots), (BodyId{6, 0}));
}

TEST(BodySlots, ASlotThatAStepSawRestsUntilOneSawItEmpty) {
    BodySlots slots;
    add(slots);
    add(slots);
    slots.step_done();
    slots.take_back(0);
    EXPECT_EQ(add(slots), BodyId{2});
    slots.take_back(2);
    EXPECT_EQ(add(slots), (BodyId{2, 1})); // this one no step has seen
    EXPECT_EQ(slots.end(), 3u);
    slots.step_done();
    EXPECT_EQ(add(slots), (BodyId{0, 1}));
    EXPECT_FALSE(slots.is_there(BodyId{0}));
    EXPECT_TRUE(slots.was_given(BodyId{0}));
    EXPECT_FALSE(slots.was_given(BodyId{0, 2}));
    EXPECT_FALSE(slots.was_given(BodyId{3}));
}

TEST(BodySlots, ListsEndWhereTheLastBodyIs) {
    BodySlots slots;
    for (int i = 0; i < 1000; ++i) add(slots);
    slots.step_done();
    for (BodySlot slot = 2; slot < 1000; ++slot) slots.take_back(slot);
    EXPECT_EQ(slots.end(), 1000u); // a step has to see that they are empty
    slots.step_done();
    EXPECT_EQ(slots.end(), 2u);
    EXPECT_EQ(add(slots), (BodyId{2, 1}));
    EXPECT_EQ(slots.end(), 3u);
}

TEST(BodySlots, AStaleIdStaysOneAfterTwoToThe31Uses) {
    BodySlots slots((std::uint32_t{1} << 31) - 2);
    std::vector<BodyId> old;
    for (int i = 0; i < 6; ++i) {
        old.push_back(add(slots));
        slots.take_back(0);
    }
    const BodyId now = add(slots);
    EXPECT_EQ(now.generation, (std::uint32_t{1} << 31) + 4);
    EXPECT_TRUE(slots.is_there(now));
    for (const BodyId id : old) EXPECT_FALSE(slots.is_there(id));
    EXPECT_FALSE(slots.is_there(BodyId{0})); // of the first use
}

TEST(BodySlots, ASlotOutOfGenerationsIsNeverGivenAgain) {
    BodySlots slots(0xffffffffu - 1);
    const BodyId first = add(slots);
    slots.take_back(0);
    const BodyId last = add(slots);
    EXPECT_EQ(last, (BodyId{0, 0xffffffffu}));
    slots.take_back(0);
    EXPECT_EQ(slots.end(), 0u);
    for (int i = 0; i < 3; ++i) {
        const BodyId id = add(slots);
        EXPECT_GT(id.slot, 0u);
        slots.step_done();
        slots.take_back(id.slot);
        slots.step_done();
    }
    EXPECT_FALSE(slots.is_there(first));
    EXPECT_FALSE(slots.is_there(last));
    EXPECT_TRUE(slots.was_given(last));
}

// Against sets: no id twice, no body in a slot that is taken or rests, and no more slots than were needed at once.
TEST(BodySlots, AMillionComeAndGo) {
    std::mt19937 random(5);
    BodySlots slots;
    std::set<BodyId> there;
    std::set<BodySlot> resting;
    std::set<BodyId> seen; // in a step
    BodyId last_of_slot[64] = {};
    for (int i = 0; i < 1000000; ++i) {
        const unsigned event = random() % 8;
        if (event == 0) {
            slots.step_done();
            resting.clear();
            seen = there;
        } else if (there.size() < 16 && event < 5) {
            const BodyId id = add(slots);
            ASSERT_LT(id.slot, 64u);
            ASSERT_TRUE(there.insert(id).second);
            ASSERT_FALSE(resting.contains(id.slot));
            if (id.generation > 0) {
                ASSERT_EQ(id, (BodyId{id.slot, last_of_slot[id.slot].generation + 1}));
            }
            last_of_slot[id.slot] = id;
        } else if (!there.empty()) {
            auto gone = there.begin();
            std::advance(gone, random() % there.size());
            slots.take_back(gone->slot);
            ASSERT_FALSE(slots.is_there(*gone));
            if (seen.contains(*gone)) resting.insert(gone->slot);
            there.erase(gone);
        }
        ASSERT_EQ(slots.count(), there.size());
    }
}

} // namespace
} // namespace raycontact
