// SPDX-License-Identifier: Apache-2.0
// What begins and ceases to touch, as sounds and damage need it: once each, whatever sleeps in between.
#include "test_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace raycontact::test {
namespace {

/// All that was told of two objects so far.
struct Log {
    int begun = 0, ended = 0;
    double speed = 0; ///< of the last that began
};

void step(TestWorld& w, const btRigidBody& body, Log& log, int steps) {
    for (int i = 0; i < steps; ++i) {
        w.steps(1);
        for (const bullet::Touch& touch : w.dispatcher.begun()) {
            if (touch.object0 != &body && touch.object1 != &body) continue;
            ++log.begun;
            log.speed = double(touch.speed);
        }
        for (const bullet::Touch& touch : w.dispatcher.ended())
            log.ended += touch.object0 == &body || touch.object1 == &body ? 1 : 0;
    }
}

using Add = std::function<btRigidBody&(TestWorld&)>;

const std::vector<Add> bodies{
    [](TestWorld& w) -> btRigidBody& { return w.add_mesh(table(), 5, at(0, 0, 1.4)); },
    [](TestWorld& w) -> btRigidBody& {
        return w.add(std::make_unique<btBoxShape>(btVector3(btScalar(0.4), btScalar(0.4), btScalar(0.4))), 5,
                     at(0, 0, 1.4));
    },
    [](TestWorld& w) -> btRigidBody& {
        return w.add(std::make_unique<btSphereShape>(btScalar(0.4)), 5, at(0, 0, 1.4));
    },
};

const std::vector<Add> grounds{
    [](TestWorld& w) -> btRigidBody& { return w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5)); },
    [](TestWorld& w) -> btRigidBody& {
        return w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0, at(0, 0, 0));
    },
};

TEST(Touches, AFallATurnAsleepAndALift) {
    for (const bool speculative : {true, false}) {
        for (const Add& ground : grounds) {
            for (const Add& body : bodies) {
                if (&ground == &grounds[1] && &body != &bodies[0]) continue; // Bullet's own pairs
                Settings settings;
                settings.speculative = speculative ? Speculative::on : Speculative::off;
                TestWorld w(settings);
                w.world.getSolverInfo().m_linearSlop = btScalar(0.001);
                ground(w);
                btRigidBody& faller = body(w);
                faller.forceActivationState(ACTIVE_TAG);
                Log log;
                step(w, faller, log, 240);
                EXPECT_EQ(log.begun, 1);
                EXPECT_EQ(log.ended, 0);
                EXPECT_NEAR(log.speed, std::sqrt(2 * 9.81 * 1.0), 0.25);
                EXPECT_EQ(w.dispatcher.stats().touching, 1u);

                step(w, faller, log, 300);
                ASSERT_FALSE(faller.isActive());
                EXPECT_EQ(w.dispatcher.stats().pairs, 0u);
                EXPECT_EQ(w.dispatcher.stats().pairs_left_alone, 1u);
                EXPECT_EQ(w.dispatcher.stats().touching, 1u);
                faller.activate();
                step(w, faller, log, 30);
                EXPECT_EQ(log.begun, 1);
                EXPECT_EQ(log.ended, 0);

                faller.setLinearVelocity(btVector3(0, 0, 3));
                step(w, faller, log, 10);
                EXPECT_EQ(log.begun, 1);
                EXPECT_EQ(log.ended, 1);
                EXPECT_EQ(w.dispatcher.stats().touching, 0u);
            }
        }
    }
}

TEST(Touches, WhatIsRemovedCeases) {
    TestWorld w;
    btRigidBody& ground = grounds[0](w);
    btRigidBody& body = bodies[0](w);
    w.steps(60);
    ASSERT_EQ(w.dispatcher.stats().touching, 1u);
    const btRigidBody* gone = &body;
    w.remove(body);
    w.steps(1);
    ASSERT_EQ(w.dispatcher.ended().size(), 1u);
    const bullet::Touch& last = w.dispatcher.ended()[0];
    EXPECT_TRUE((last.object0 == gone && last.object1 == &ground) || (last.object1 == gone && last.object0 == &ground));
    EXPECT_EQ(w.dispatcher.stats().touching, 0u);
    w.steps(1);
    EXPECT_TRUE(w.dispatcher.ended().empty());
}

} // namespace
} // namespace raycontact::test
