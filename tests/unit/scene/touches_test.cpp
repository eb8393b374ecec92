// SPDX-License-Identifier: Apache-2.0
// Which bodies touch, from step to step; and what keeps bodies from being a pair.
#include <raycontact/scene.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

namespace raycontact {
namespace {

using namespace reference;

Pose at(double x, double z = 0) {
    return {.translation = {x, 0, z}};
}

class TouchesOfBoxes : public testing::Test {
protected:
    std::set<std::pair<BodyId, BodyId>> ids(std::span<const Touch> touches) const {
        std::set<std::pair<BodyId, BodyId>> found;
        for (const Touch& touch : touches) found.insert({touch.body_a, touch.body_b});
        EXPECT_EQ(found.size(), touches.size());
        return found;
    }
    /// After a step: how many began, ended, and touch.
    using Counts = std::array<std::size_t, 3>;
    Counts step() {
        scene.find_contacts();
        auto followed = last;
        for (const auto& pair : ids(scene.ended())) EXPECT_EQ(followed.erase(pair), 1u) << "ended, but did not touch";
        for (const auto& pair : ids(scene.begun())) EXPECT_TRUE(followed.insert(pair).second) << "touched before";
        last = ids(scene.touching());
        EXPECT_EQ(followed, last);
        return {scene.begun().size(), scene.ended().size(), scene.touching().size()};
    }
    std::shared_ptr<const Shape> box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    Scene scene;
    std::set<std::pair<BodyId, BodyId>> last;
};

TEST_F(TouchesOfBoxes, BeginOnceAndEndOnceApart) {
    const BodyId a = scene.add(box, at(0)), b = scene.add(box, at(1.2));
    const double trembles = speculative_share * std::sqrt(3.0);
    EXPECT_EQ(step(), (Counts{0, 0, 0}));
    scene.set_pose(b, at(0.99));
    EXPECT_EQ(step(), (Counts{1, 0, 1}));
    const Touch touch = scene.begun()[0];
    EXPECT_EQ(touch.body_a, a);
    EXPECT_EQ(touch.body_b, b);
    EXPECT_NEAR(double(touch.depth), 0.01, 1e-6);
    EXPECT_NEAR(double(touch.normal.x), 1, 1e-6);
    EXPECT_NEAR(touch.point.x, 0.495, 1e-6);
    EXPECT_FALSE(touch.sensor);
    EXPECT_EQ(step(), (Counts{0, 0, 1})) << "at rest";
    for (int i = 0; i < 20; ++i) { // it trembles
        scene.set_pose(b, at(i % 2 == 0 ? 1 + 0.9 * trembles : 0.9999));
        EXPECT_EQ(step(), (Counts{0, 0, 1})) << i;
    }
    scene.set_pose(b, at(1 + 1.1 * trembles));
    EXPECT_EQ(step(), (Counts{0, 1, 0}));
    scene.set_pose(b, at(1 + 0.5 * trembles));
    EXPECT_EQ(step(), (Counts{0, 0, 0})) << "it does not touch yet";
    scene.set_pose(b, at(0.5));
    EXPECT_EQ(step(), (Counts{1, 0, 1}));
    scene.remove(b);
    const BodyId c = scene.add(box, at(0.5));
    EXPECT_EQ(step(), (Counts{1, 1, 1})) << "another body in its place";
    EXPECT_EQ(scene.ended()[0].body_b, b);
    EXPECT_EQ(scene.begun()[0].body_b, c);
    scene.clear();
    EXPECT_EQ(scene.body_count(), 0u);
    EXPECT_FALSE(scene.has(a));
    EXPECT_EQ(step(), (Counts{0, 1, 0}));
}

// A solver with speculative contacts stops bodies at the surface: no contact ever has a depth.
TEST_F(TouchesOfBoxes, SpeculativeContactsTouchWhenTheyWill) {
    Settings settings;
    settings.speculative = Speculative::on;
    scene.set_settings(settings);
    const BodyId a = scene.add(box, at(0));
    const BodyId b = scene.add(box, at(1.05));
    scene.find_contacts();
    scene.set_pose(b, at(1.03));
    scene.set_next_pose(b, at(1.01));
    scene.set_next_pose(a, at(0));
    EXPECT_EQ(step(), (Counts{0, 0, 0}));
    scene.set_pose(b, at(1.01));
    scene.set_next_pose(b, at(0.99));
    EXPECT_EQ(step(), (Counts{1, 0, 1}));
    for (int i = 0; i < 10; ++i) {
        scene.set_pose(b, at(1 + 1e-4 * (i % 3)));
        scene.set_next_pose(b, at(1 + 1e-4 * (i % 3)));
        EXPECT_EQ(step(), (Counts{0, 0, 1})) << i;
    }
    scene.set_pose(b, at(1.02));
    scene.set_next_pose(b, at(1.04));
    EXPECT_EQ(step(), (Counts{0, 1, 0}));
}

TEST_F(TouchesOfBoxes, StaticBodiesMakeNoPairsAndSleepersGoOnTouching) {
    const BodyId a = scene.add(box, at(0)), b = scene.add(box, at(0.9)), c = scene.add(box, at(1.8));
    scene.set_static(a, true);
    EXPECT_TRUE(scene.is_static(a));
    EXPECT_FALSE(scene.is_static(b));
    EXPECT_EQ(step(), (Counts{2, 0, 2}));
    scene.set_static(b, true);
    EXPECT_EQ(step(), (Counts{0, 0, 2})) << "they sleep on each other";
    EXPECT_EQ(scene.pairs().size(), 1u);
    EXPECT_TRUE(scene.contacts(a, b).empty());
    scene.set_pose(c, at(1.85));
    EXPECT_EQ(step(), (Counts{0, 0, 2}));
    scene.set_static(b, false);
    EXPECT_EQ(step(), (Counts{0, 0, 2})) << "it wakes";
    EXPECT_EQ(scene.pairs().size(), 2u);
    EXPECT_FALSE(scene.contacts(a, b).empty());
    scene.set_static(b, true);
    step();
    scene.set_pose(b, at(0.9, 5));
    EXPECT_EQ(step(), (Counts{0, 2, 0})) << "moved away, static or not";
    scene.set_filter(b, 2, 2); // it stays static
    EXPECT_TRUE(scene.is_static(b));
    EXPECT_THROW(scene.set_static(BodyId{9, 0}, true), InputError);
    EXPECT_THROW(scene.is_static(BodyId{9, 0}), InputError);
}

TEST_F(TouchesOfBoxes, FiltersEndThem) {
    const BodyId a = scene.add(box, at(0)), b = scene.add(box, at(0.9));
    scene.add(box, at(1.8));
    EXPECT_EQ(step(), (Counts{2, 0, 2}));
    scene.set_filter(a, 2, 2);
    EXPECT_EQ(step(), (Counts{0, 1, 1}));
    scene.set_filter(a, 3, 3);
    EXPECT_EQ(step(), (Counts{1, 0, 2}));
    scene.set_pair_filter([&](BodyId, BodyId second) { return second == b; });
    EXPECT_EQ(step(), (Counts{0, 1, 1}));
    scene.set_pair_filter({});
    EXPECT_EQ(step(), (Counts{1, 0, 2}));
    scene.forget_contacts();
    EXPECT_TRUE(scene.touching().empty());
    last.clear();
    EXPECT_EQ(step(), (Counts{2, 0, 2}));
    scene.set_static(a, true);
    scene.set_static(b, true);
    EXPECT_EQ(step(), (Counts{0, 0, 2}));
    scene.set_filter(a, 4, 4); // nothing moves, and no pair closes
    EXPECT_EQ(step(), (Counts{0, 1, 1}));
}

// What is given is tested whatever filters say, and trembles as others do.
TEST_F(TouchesOfBoxes, OfGivenPairsKnowNoFilters) {
    const BodyId a = scene.add(box, at(0)), b = scene.add(box, at(0.99));
    scene.set_filter(a, 1, 0);
    const std::vector<Pair> given{{a, b}};
    scene.find_contacts(given);
    EXPECT_EQ(scene.touching().size(), 1u);
    scene.set_pose(b, at(1.0005));
    scene.find_contacts(given);
    EXPECT_EQ(scene.touching().size(), 1u);
    scene.set_sensor(b, true);
    scene.find_contacts(given);
    ASSERT_EQ(scene.touching().size(), 1u);
    EXPECT_TRUE(scene.touching()[0].sensor) << "without a contact, too";
    scene.find_contacts();
    EXPECT_EQ(scene.ended().size(), 1u);
}

TEST_F(TouchesOfBoxes, SensorsTouchWithoutContacts) {
    const BodyId a = scene.add(box, at(0)), b = scene.add(box, at(0.9)), c = scene.add(box, at(1.8));
    scene.set_sensor(b, true);
    EXPECT_TRUE(scene.is_sensor(b));
    EXPECT_EQ(step(), (Counts{2, 0, 2}));
    EXPECT_TRUE(scene.contacts().empty());
    EXPECT_EQ(scene.stats().contacts, 0u);
    EXPECT_TRUE(scene.begun()[0].sensor);
    EXPECT_NEAR(double(scene.begun()[0].depth), 0.1, 1e-6);
    EXPECT_EQ(step(), (Counts{0, 0, 2}));
    scene.set_pose(c, at(1.7));
    EXPECT_EQ(step(), (Counts{0, 0, 2})) << "one pair alone is asked about";
    scene.set_sensor(b, false);
    EXPECT_EQ(step(), (Counts{0, 0, 2}));
    EXPECT_FALSE(scene.contacts(a, b).empty());
    EXPECT_FALSE(scene.touching()[0].sensor);
    scene.set_sensor(b, true);
    scene.set_pose(c, at(9));
    EXPECT_EQ(step(), (Counts{0, 1, 1}));
    EXPECT_TRUE(scene.contacts().empty());
    scene.remove(b);
    const BodyId next = scene.add(box, at(0.9));
    EXPECT_FALSE(scene.is_sensor(next));
    EXPECT_EQ(step(), (Counts{1, 1, 1}));
    EXPECT_FALSE(scene.contacts().empty());
}

TEST_F(TouchesOfBoxes, PairFilterIsAskedOnceForEachMeeting) {
    std::vector<BodyId> bodies;
    bodies.reserve(4);
    for (int i = 0; i < 4; ++i) bodies.push_back(scene.add(box, at(0.9 * i)));
    std::map<std::pair<BodyId, BodyId>, int> asked;
    const auto odd = [&](BodyId a, BodyId b) {
        EXPECT_LT(a.slot, b.slot);
        ++asked[{a, b}];
        return a.slot % 2 == 1;
    };
    scene.set_pair_filter(odd);
    const std::vector<Pair> kept{{bodies[1], bodies[2]}};
    for (int i = 0; i < 3; ++i) {
        scene.find_contacts();
        EXPECT_EQ(std::vector(scene.pairs().begin(), scene.pairs().end()), kept);
        scene.set_pose(bodies[0], at(0.01 * i));
    }
    EXPECT_EQ(asked.size(), 3u);
    for (const auto& [pair, times] : asked) EXPECT_EQ(times, 1);
    scene.set_pose(bodies[0], at(-5));
    scene.find_contacts();
    scene.set_pose(bodies[0], at(0));
    scene.find_contacts();
    EXPECT_EQ((asked[{bodies[0], bodies[1]}]), 2) << "they met again";
    EXPECT_EQ((asked[{bodies[1], bodies[2]}]), 1);
    scene.find_contacts(std::vector<Pair>{{bodies[0], bodies[1]}});
    EXPECT_FALSE(scene.contacts(bodies[0], bodies[1]).empty()) << "given pairs are tested";
    scene.find_contacts();
    EXPECT_EQ(std::vector(scene.pairs().begin(), scene.pairs().end()), kept);
    scene.set_pair_filter([](BodyId, BodyId) -> bool { throw std::runtime_error("no"); });
    EXPECT_THROW(scene.find_contacts(), std::runtime_error);
    scene.set_pair_filter({});
    scene.find_contacts();
    EXPECT_EQ(scene.pairs().size(), 3u);
}

// What slides along without a contact for a while, or rolls, goes on; what lifts, or goes by, ends.
TEST_F(TouchesOfBoxes, GoByThePointsThatTouchedLast) {
    const BodyId a = scene.add(box, at(0)), b = scene.add(box, at(0.99));
    EXPECT_EQ(step(), (Counts{1, 0, 1}));
    for (const double along : {0.1, 0.2, 0.3}) { // 0.43 is a quarter of the diagonal
        scene.set_pose(b, at(1.001, along));
        EXPECT_EQ(step(), (Counts{0, 0, 1})) << along;
    }
    scene.set_pose(b, at(1.001, 0.7));
    EXPECT_EQ(step(), (Counts{0, 1, 0})) << "far from where it touched";
    scene.set_pose(b, at(0.99, 0));
    EXPECT_EQ(step(), (Counts{1, 0, 1}));
    scene.set_pose(b, at(-1.01));
    EXPECT_EQ(step(), (Counts{0, 1, 0})) << "on the other side";
    scene.set_pose(a, at(-0.02));
    EXPECT_EQ(step(), (Counts{1, 0, 1}));
}

// Many bodies move, some of them, or none: the touches are those that one scene with all pairs asked anew has.
TEST(Touches, DoNotDependOnWhichPairsAStepAsksAbout) {
    std::mt19937 random(67);
    const auto number = [&] { return double(random()) / 4294967296.0; };
    const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    Scene scene;
    std::vector<BodyId> bodies;
    const auto place = [&] { return Pose{.translation = {6 * number(), 6 * number(), 6 * number()}}; };
    bodies.reserve(60);
    for (int i = 0; i < 60; ++i) bodies.push_back(scene.add(box, place()));
    std::set<std::pair<BodyId, BodyId>> touching;
    for (int step = 0; step < 60; ++step) {
        const double share = step % 5 == 0 ? 1 : 0.1 * (step % 3);
        for (BodyId& body : bodies) {
            if (number() > share) continue;
            if (number() < 0.05) {
                scene.remove(body);
                body = scene.add(box, place());
            } else if (number() < 0.2) {
                scene.set_static(body, !scene.is_static(body));
            } else {
                scene.set_pose(body, place());
            }
        }
        scene.find_contacts();
        for (const Touch& touch : scene.ended()) EXPECT_EQ(touching.erase({touch.body_a, touch.body_b}), 1u);
        for (const Touch& touch : scene.begun()) touching.insert({touch.body_a, touch.body_b});
        std::set<std::pair<BodyId, BodyId>> told;
        for (const Touch& touch : scene.touching()) told.insert({touch.body_a, touch.body_b});
        EXPECT_EQ(told, touching);
        const auto with_depth = [&] {
            std::set<std::pair<BodyId, BodyId>> pairs;
            for (const Contact& c : scene.contacts()) pairs.insert({c.body_a, c.body_b});
            return pairs;
        }();
        for (const auto& pair : with_depth) EXPECT_EQ(told.count(pair), 1u);
        for (const auto& [a, b] : told)
            if (!scene.is_static(a) || !scene.is_static(b)) {
                EXPECT_LE(scene.distance(a, b)->distance, 0.36 * std::sqrt(3.0)) << "no farther than it may slide";
            }
    }
}

} // namespace
} // namespace raycontact
