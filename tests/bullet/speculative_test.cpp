// SPDX-License-Identifier: Apache-2.0
// Speculative contacts in a Bullet world: what is fast stays on its side of a thin wall.
#include "test_world.h"

#include <convert.h>

#include <gtest/gtest.h>

#include <cmath>

namespace raycontact::test {
namespace {

struct Flight {
    std::shared_ptr<const Shape> shape;
    double speed; ///< down, m/s
    btVector3 spin;
    double start = 3; ///< metres above a slab of 5 cm
    bool slab_gives_way = false;
};

// Whether the body is still above the slab after a second.
bool is_stopped(const Flight& flight, bool speculative) {
    Settings settings;
    settings.devices = "cpu";
    settings.speculative = speculative;
    TestWorld w(settings);
    w.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    btRigidBody& slab = w.add_mesh(Shape::make(box_mesh(8, 8, 0.05)), flight.slab_gives_way ? 2000 : 0, at(0, 0, 0));
    if (flight.slab_gives_way) slab.setGravity(btVector3(0, 0, 0));
    btRigidBody& body = w.add_mesh(flight.shape, 1, at(0.1, 0.2, flight.start));
    body.setLinearVelocity(btVector3(0, 0, btScalar(-flight.speed)));
    body.setAngularVelocity(flight.spin);
    w.steps(60);
    return body.getWorldTransform().getOrigin().z() > slab.getWorldTransform().getOrigin().z();
}

std::shared_ptr<const Shape> small_torus() {
    return bullet::stretch_shape(*torus(), {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3});
}

TEST(Speculative, AFastTorusDoesNotPassAThinSlab) {
    for (const double speed : {20.0, 45.0, 100.0}) {
        int stopped = 0, stopped_without = 0;
        constexpr int flights = 8;
        for (int i = 0; i < flights; ++i) {
            const Flight flight{small_torus(), speed, btVector3(3, 1, 2), 3 + speed / 60 * i / flights};
            stopped += is_stopped(flight, true);
            stopped_without += is_stopped(flight, false);
        }
        EXPECT_EQ(stopped, flights) << speed << " m/s";
        EXPECT_LT(stopped_without, flights) << "else nothing is shown, at " << speed << " m/s";
    }
}

TEST(Speculative, NorDoesACoarseTableOrASlabThatGivesWay) {
    EXPECT_TRUE(is_stopped({table(), 30, btVector3(0, 0, 0)}, true));
    EXPECT_TRUE(is_stopped({table(), 30, btVector3(1, 5, 0)}, true));
    EXPECT_TRUE(is_stopped({small_torus(), 30, btVector3(1, 5, 0), 3, true}, true));
}

// Points to come are no contacts: a body that hovers above the ground has none, and nothing lifts it.
TEST(Speculative, NothingIsTouchedEarly) {
    Settings settings;
    settings.devices = "cpu";
    settings.speculative = true;
    TestWorld w(settings);
    w.world.setGravity(btVector3(0, 0, 0));
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(torus(), 1, at(0, 0, 1.5));
    body.setLinearVelocity(btVector3(0, 0, -12)); // 20 cm a step
    std::uint64_t speculative = 0;
    for (int i = 0; i < 8; ++i) {
        const double before = double(body.getWorldTransform().getOrigin().z());
        w.steps(1);
        const double now = double(body.getWorldTransform().getOrigin().z());
        btVector3 low, high;
        body.getCollisionShape()->getAabb(body.getWorldTransform(), low, high);
        EXPECT_GT(double(low.z()), -0.01) << "step " << i;
        EXPECT_LT(w.dispatcher.scene().stats().depth_max, 0.01);
        speculative += w.dispatcher.scene().stats().contacts_speculative;
        EXPECT_LE(now, before + 1e-4);
        if (double(low.z()) > 0.25) {
            EXPECT_NEAR(before - now, 0.2, 1e-3) << "step " << i;
        }
    }
    EXPECT_GT(speculative, 0u);
}

struct Impact {
    double restitution, speed; ///< down, m/s
    double slop = 0.002;
    int split_impulse = 1;
    std::shared_ptr<const Shape> shape = table();
    bool soft = false;
};

/// The part of its speed that a body has after it hit a slab, with and without speculative contacts.
double bounce(bool speculative, const Impact& impact) {
    Settings settings;
    settings.speculative = speculative;
    TestWorld w(settings);
    w.world.setGravity(btVector3(0, 0, 0));
    w.world.getSolverInfo().m_linearSlop = btScalar(impact.slop);
    w.world.getSolverInfo().m_splitImpulse = impact.split_impulse;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5)).setRestitution(1);
    btRigidBody& body = w.add_mesh(impact.shape, 5, at(0, 0, 1));
    body.setRestitution(btScalar(impact.restitution));
    body.setLinearVelocity(btVector3(0, 0, btScalar(-impact.speed)));
    if (impact.soft) body.setContactStiffnessAndDamping(10, 100);
    w.steps(static_cast<int>(std::ceil(60 * 1.5 / impact.speed)));
    return double(body.getLinearVelocity().z()) / impact.speed;
}

TEST(Speculative, BodiesBounceAsWithoutIt) {
    for (const double restitution : {0.0, 0.3, 0.9}) {
        for (const double speed : {2.0, 5.0, 12.0}) {
            const Impact impact{restitution, speed};
            EXPECT_NEAR(bounce(true, impact), restitution, 0.005) << speed;
            if (restitution > 0) { // Bullet's solver adds what pushes it out
                EXPECT_NEAR(bounce(false, impact), restitution, 0.07) << speed;
            }
        }
    }
}

// Nor does the way that splits depth from speed, nor how soft the contact is.
TEST(Speculative, NoSlopTakesFromTheRebound) {
    const auto small = Shape::make(box_mesh(0.1, 0.1, 0.1));
    for (const double slop : {0.0, 0.001, 0.005, 0.01, 0.1}) {
        for (const double speed : {1.0, 3.0}) {
            for (const int split : {0, 1})
                EXPECT_NEAR(bounce(true, {0.9, speed, slop, split}), 0.9, 0.005)
                    << slop << ' ' << speed << ' ' << split;
            EXPECT_NEAR(bounce(true, {0.9, speed, slop, 1, small}), 0.9, 0.005) << slop << ' ' << speed;
        }
    }
    // Slower than 0.2 m/s after the impact.
    EXPECT_NEAR(bounce(true, {0.3, 0.5, 0.01, 1, small}), 0.3, 0.005);
    const Impact soft{0.9, 1, 0, 1, table(), true};
    EXPECT_LT(bounce(false, soft), 0.85) << "else nothing is shown";
    EXPECT_NEAR(bounce(true, soft), bounce(false, soft), 0.01);
}

// What the solver is told is no depth: the point's places and what the callbacks get are true.
TEST(Speculative, APointThatBouncesIsWhereItIs) {
    Settings settings;
    settings.speculative = true;
    TestWorld w(settings);
    w.world.setGravity(btVector3(0, 0, 0));
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5)).setRestitution(1);
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.41));
    body.setRestitution(1);
    body.setLinearVelocity(btVector3(0, 0, -3));
    static btScalar least; // a callback has no state
    least = 1;
    gContactProcessedCallback = [](btManifoldPoint& point, void*, void*) {
        least = btMin(least, point.getDistance());
        return true;
    };
    w.steps(1);
    gContactProcessedCallback = nullptr;
    EXPECT_NEAR(double(least), 0.01, 1e-4);
    ASSERT_GT(w.touching(), 0);
    const btManifoldPoint& point = w.dispatcher.getManifoldByIndexInternal(0)->getContactPoint(0);
    const btVector3 gap = point.m_positionWorldOnA - point.m_positionWorldOnB;
    EXPECT_NEAR(double(btFabs(gap.z())), 0.01, 1e-4);
    EXPECT_LT(double(point.getDistance()), -0.1);
}

} // namespace
} // namespace raycontact::test
