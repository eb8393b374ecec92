// SPDX-License-Identifier: Apache-2.0
#include <raycontact/scene.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

Pose at(double x) {
    return {.translation = {x, 0, 0}};
}

class BodyNotes : public testing::Test {
protected:
    std::shared_ptr<const Shape> box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    Scene scene;
    BodyId a = scene.add(box, at(0)), b = scene.add(box, at(0.9)), c = scene.add(box, at(1.8));
};

TEST_F(BodyNotes, ContactsOfOnePair) {
    const auto all = scene.step();
    const auto ab = scene.contacts(a, b), bc = scene.contacts(c, b);
    EXPECT_GT(ab.size(), 0u);
    EXPECT_GT(bc.size(), 0u);
    EXPECT_EQ(ab.size() + bc.size(), all.size());
    for (const Contact& contact : bc) {
        EXPECT_EQ(contact.body_a, slot_of(b));
        EXPECT_EQ(contact.body_b, slot_of(c));
    }
    EXPECT_TRUE(scene.contacts(a, c).empty());
    EXPECT_TRUE(scene.contacts(a, a).empty());
    scene.remove(c);
    EXPECT_THROW(scene.contacts(a, c), InputError);
}

TEST_F(BodyNotes, UserDataBelongsToTheBody) {
    EXPECT_EQ(scene.user_data(b), 0u);
    scene.set_user_data(b, 0xfedcba9876543210u);
    EXPECT_EQ(scene.user_data(b), 0xfedcba9876543210u);
    scene.remove(b);
    EXPECT_THROW(scene.user_data(b), InputError);
    EXPECT_THROW(scene.set_user_data(b, 1), InputError);
    const BodyId next = scene.add(box);
    EXPECT_EQ(slot_of(next), slot_of(b));
    EXPECT_EQ(scene.user_data(next), 0u);
}

TEST_F(BodyNotes, FiltersNeedBothMasks) {
    scene.step();
    EXPECT_EQ(scene.pairs().size(), 2u);
    scene.set_filter(b, 2, 0xffffffffu); // others' masks have all bits
    scene.step();
    EXPECT_EQ(scene.pairs().size(), 2u);
    scene.set_filter(a, 1, 1); // does not want group 2
    scene.step();
    ASSERT_EQ(scene.pairs().size(), 1u);
    EXPECT_EQ(scene.pairs()[0], Pair(b, c));
    scene.set_filter(b, 2, 4); // wants group 4 alone
    scene.step();
    EXPECT_TRUE(scene.pairs().empty());
    scene.set_filter(c, 4, 2);
    scene.step();
    EXPECT_EQ(scene.pairs().size(), 1u);
    const Pair given{a, b};
    EXPECT_FALSE(scene.step({&given, 1}).empty()) << "a pair that is given is tested";
}

} // namespace
} // namespace raycontact
