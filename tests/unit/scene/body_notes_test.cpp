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
    const auto all = scene.find_contacts();
    const auto ab = scene.contacts(a, b), bc = scene.contacts(c, b);
    EXPECT_GT(ab.size(), 0u);
    EXPECT_GT(bc.size(), 0u);
    EXPECT_EQ(ab.size() + bc.size(), all.size());
    for (const Contact& contact : bc) {
        EXPECT_EQ(contact.body_a, b);
        EXPECT_EQ(contact.body_b, c);
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
    EXPECT_EQ(next.slot, b.slot);
    EXPECT_EQ(scene.user_data(next), 0u);
}

// The pairs of a step in which nothing moved are those of the last one, but for what was said meanwhile.
TEST_F(BodyNotes, PairsOfBodiesAtRestFollowWhatIsSaid) {
    const auto pairs = [&] {
        scene.find_contacts();
        return std::vector(scene.pairs().begin(), scene.pairs().end());
    };
    const std::vector<Pair> all{{a, b}, {b, c}};
    EXPECT_EQ(pairs(), all);
    EXPECT_EQ(pairs(), all);
    scene.find_contacts(std::vector<Pair>{{a, c}});
    EXPECT_EQ(pairs(), all) << "another list in between";
    scene.set_filter(c, 0, 0);
    EXPECT_EQ(pairs(), (std::vector<Pair>{{a, b}}));
    scene.set_filter(c, 1, 1);
    scene.set_pose(b, at(30));
    scene.find_contacts(std::vector<Pair>{{a, b}, {b, c}});
    scene.set_pose(b, at(0.9));
    EXPECT_EQ(pairs(), all) << "moved and back, beside the broad phase";
    scene.remove(b);
    EXPECT_TRUE(pairs().empty());
    const BodyId again = scene.add(box, at(0.9));
    ASSERT_EQ(again.slot, b.slot);
    EXPECT_EQ(pairs(), (std::vector<Pair>{{a, again}, {again, c}})) << "another body in its slot";
    scene.remove(again);
    const BodyId last = scene.add(box, at(0.9));
    EXPECT_EQ(pairs(), last.slot < c.slot ? (std::vector<Pair>{{a, last}, {last, c}})
                                          : (std::vector<Pair>{{a, last}, {c, last}}));
}

TEST_F(BodyNotes, FiltersNeedBothMasks) {
    scene.find_contacts();
    EXPECT_EQ(scene.pairs().size(), 2u);
    scene.set_filter(b, 2, 0xffffffffu); // others' masks have all bits
    scene.find_contacts();
    EXPECT_EQ(scene.pairs().size(), 2u);
    scene.set_filter(a, 1, 1); // does not want group 2
    scene.find_contacts();
    ASSERT_EQ(scene.pairs().size(), 1u);
    EXPECT_EQ(scene.pairs()[0], Pair(b, c));
    scene.set_filter(b, 2, 4); // wants group 4 alone
    scene.find_contacts();
    EXPECT_TRUE(scene.pairs().empty());
    scene.set_filter(c, 4, 2);
    scene.find_contacts();
    EXPECT_EQ(scene.pairs().size(), 1u);
    const Pair given{a, b};
    EXPECT_FALSE(scene.find_contacts({&given, 1}).empty()) << "a pair that is given is tested";
}

TEST_F(BodyNotes, PosesInBulkAreAllSetOrNone) {
    const std::vector<BodyId> ids{c, a};
    scene.set_poses(ids, std::vector<Pose>{at(4), at(5)});
    EXPECT_EQ(scene.pose(a), at(5));
    EXPECT_EQ(scene.pose(b), at(0.9));
    EXPECT_EQ(scene.pose(c), at(4));
    const auto refusal = [&](const std::vector<BodyId>& bodies, const std::vector<Pose>& poses) {
        try {
            scene.set_poses(bodies, poses);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    Pose flat = at(7);
    flat.rotation[4] = 0;
    EXPECT_EQ(refusal(ids, {at(7)}), "Scene::set_poses: 1 poses for 2 bodies; give one for each");
    EXPECT_EQ(refusal(ids, {at(7), flat}).find("Scene::set_poses, place 1: body 0: "), 0u);
    scene.remove(b);
    EXPECT_EQ(refusal({c, b}, {at(7), at(7)}).find("Scene::set_poses, place 1: body 1 (generation 0) was removed"), 0u);
    EXPECT_EQ(scene.pose(c), at(4));
    EXPECT_FALSE(scene.has(b));
    EXPECT_TRUE(scene.has(c));
}

TEST_F(BodyNotes, WitnessPointsAreADepthApart) {
    for (const Contact& contact : scene.find_contacts()) {
        const double by = double(contact.depth);
        const Vec3 n = contact.normal, p = contact.point_a, q = contact.point_b;
        EXPECT_NEAR(p.x - q.x, by * n.x, 1e-12);
        EXPECT_NEAR(p.y - q.y, by * n.y, 1e-12);
        EXPECT_NEAR(p.z - q.z, by * n.z, 1e-12);
        EXPECT_EQ(contact.point(), contact.feature.source == Side::a ? p : q);
    }
}

} // namespace
} // namespace raycontact
