// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raycontact {
namespace {

using namespace reference;

Pose at(double x, double y, double z) {
    return {.translation = {x, y, z}};
}

TEST(Collide, FindsWhatASceneFinds) {
    Random random(3);
    std::size_t contacts = 0;
    for (int i = 0; i < 100; ++i) {
        const Placement p = random_placement(pointers(closed_subjects()), random);
        for (const Direction direction : {Direction::ray, Direction::reprojected, Direction::weighted})
            for (const Features features : {Features::vertices, Features::edges}) {
                Settings settings;
                settings.direction = direction;
                settings.features = features;
                Scene scene(settings);
                scene.add(p.a->shape, p.pose_a);
                scene.add(p.b->shape, p.pose_b);
                const Pair pair{BodyId{0}, BodyId{1}};
                const auto expected = scene.find_contacts({&pair, 1});
                const auto found = collide(*p.a->shape, p.pose_a, *p.b->shape, p.pose_b,
                                           {.direction = direction, .features = features});
                EXPECT_TRUE(same_bits(expected, found));
                contacts += found.size();
            }
    }
    EXPECT_GT(contacts, 500u);
}

// A thread asks in one scene again and again: nothing of a question is left for the next, and no shape is kept.
TEST(Collide, KeepsNothingOfTheLastQuestion) {
    Random random(4);
    std::size_t contacts = 0;
    for (int i = 0; i < 200; ++i) {
        const Placement p = random_placement(pointers(closed_subjects()), random);
        if (i % 8 == 7) { // another question in between, with options of its own
            collide(*p.b->shape, p.pose_b, *p.a->shape, p.pose_a, {.features = Features::vertices, .threads = 2});
            collide(*p.b->shape, p.pose_b, *p.a->shape, p.pose_a, {.direction = Direction::ray});
        }
        Scene scene;
        const Pair pair{scene.add(p.a->shape, p.pose_a), scene.add(p.b->shape, p.pose_b)};
        const auto expected = scene.find_contacts({&pair, 1});
        const auto found = collide(*p.a->shape, p.pose_a, *p.b->shape, p.pose_b);
        EXPECT_TRUE(same_bits(expected, found));
        contacts += found.size();
    }
    EXPECT_GT(contacts, 100u);
    std::weak_ptr<const Shape> gone;
    {
        const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
        EXPECT_FALSE(collide(*box, {}, *box, at(0, 0, 0.9)).empty());
        gone = box;
    }
    EXPECT_TRUE(gone.expired());
}

// A is above B and 0.1 m too low, so its point is below that of B.
TEST(Collide, WitnessPointsAreADepthApart) {
    const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    const auto small = Shape::make(box_mesh({0.2, 0.2, 0.2}));
    for (const bool swapped : {false, true}) {
        const auto contacts = swapped ? collide(*box, at(0, 0, 0), *small, at(0, 0, 0.6))
                                      : collide(*small, at(0, 0, 0.6), *box, at(0, 0, 0));
        ASSERT_FALSE(contacts.empty());
        for (const Contact& c : contacts) {
            const Vec3 a = c.point_a, b = c.point_b;
            EXPECT_NEAR(a.z, swapped ? 0.5 : 0.4, 1e-6);
            EXPECT_NEAR(b.z, swapped ? 0.4 : 0.5, 1e-6);
            EXPECT_NEAR(c.depth, 0.1, 1e-6);
            const Vec3 apart{a.x - b.x, a.y - b.y, a.z - b.z};
            EXPECT_NEAR(apart.x, double(c.depth) * double(c.normal.x), 1e-6);
            EXPECT_NEAR(apart.y, double(c.depth) * double(c.normal.y), 1e-6);
            EXPECT_NEAR(apart.z, double(c.depth) * double(c.normal.z), 1e-6);
        }
    }
}

TEST(Collide, RefusesAPoseThatIsNotRigid) {
    const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    Pose twice;
    twice.rotation[0] = 2;
    EXPECT_THROW(collide(*box, {}, *box, twice), InputError);
    EXPECT_THROW(intersects(*box, {}, *box, twice), InputError);
    EXPECT_THROW(intersects(*box, at(NAN, 0, 0), *box, {}), InputError);
}

TEST(Collide, AMarginHasThoseThatAreNear) {
    Random random(6);
    int near = 0, far = 0;
    for (int i = 0; i < 300; ++i) {
        const Placement p = random_placement(pointers(closed_subjects()), random);
        const Vec3 away = 0.3 * random.in_ball();
        const Pose pose_b{p.pose_b.rotation, p.pose_b.translation + away};
        const auto apart = distance(*p.a->shape, p.pose_a, *p.b->shape, pose_b)->distance;
        if (apart == 0) continue;
        EXPECT_TRUE(collide(*p.a->shape, p.pose_a, *p.b->shape, pose_b, {.margin = 0.99 * apart}).empty());
        const auto found = collide(*p.a->shape, p.pose_a, *p.b->shape, pose_b, {.margin = 1.1 * apart});
        ASSERT_FALSE(found.empty()) << i;
        double least = 1e30;
        for (const Contact& c : found) {
            EXPECT_TRUE(c.is_speculative());
            EXPECT_LE(-double(c.depth), 1.1 * apart * (1 + 1e-6));
            least = std::min(least, -double(c.depth));
        }
        EXPECT_NEAR(least, apart, 0.1 * apart + 1e-6);
        const auto some =
            collide(*p.a->shape, p.pose_a, *p.b->shape, pose_b, {.margin = 2 * apart, .max_contacts_per_pair = 2});
        EXPECT_LE(some.size(), 2u);
        EXPECT_FALSE(some.empty());
        (apart > 0.05 ? far : near) += 1;
    }
    EXPECT_GT(near, 10);
    EXPECT_GT(far, 10);
    const auto& shape = *closed_subjects()[0].shape;
    for (const double margin : {-1.0, 1e13, std::nan("")})
        EXPECT_THROW(collide(shape, {}, shape, {}, {.margin = margin}), InputError);
}

} // namespace
} // namespace raycontact
