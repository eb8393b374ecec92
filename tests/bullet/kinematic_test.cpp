// SPDX-License-Identifier: Apache-2.0
// Kinematic objects push what is in their way: a hand or a bat that the caller moves, 60 times a second.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>

#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btSimpleBroadphase.h>
#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <set>
#include <string>

namespace raycontact::test {
namespace {

constexpr btScalar dt = btScalar(1.0 / 60);

/// A world with a broad phase of one's choice, and a floor.
struct HandWorld {
    explicit HandWorld(std::unique_ptr<btBroadphaseInterface> b = std::make_unique<btDbvtBroadphase>(),
                       const Settings& settings = {})
        : dispatcher(&configuration, settings), broadphase(std::move(b)),
          world(&dispatcher, broadphase.get(), &solver, &configuration) {
        world.setGravity(btVector3(0, 0, btScalar(-9.81)));
        bullet::recommend(world);
        add(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(20, 8, 1))), 0, at(0, 0, -0.5));
    }
    ~HandWorld() {
        for (const auto& body : bodies) world.removeRigidBody(body.get());
    }
    btRigidBody& add(std::unique_ptr<btCollisionShape> shape, double mass, const btTransform& pose,
                     bool kinematic = false) {
        btVector3 inertia(0, 0, 0);
        if (mass > 0) shape->calculateLocalInertia(btScalar(mass), inertia);
        btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shape.get(), inertia);
        info.m_startWorldTransform = pose;
        bodies.push_back(std::make_unique<btRigidBody>(info));
        shapes.push_back(std::move(shape));
        btRigidBody& body = *bodies.back();
        if (kinematic) {
            body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
            body.setActivationState(DISABLE_DEACTIVATION);
        }
        world.addRigidBody(&body);
        return body;
    }
    void step() { world.stepSimulation(dt, 0); }
    std::set<const btCollisionObject*> partners_of(const btCollisionObject& object) {
        std::set<const btCollisionObject*> found;
        const btBroadphasePairArray& pairs = broadphase->getOverlappingPairCache()->getOverlappingPairArray();
        for (int i = 0; i < pairs.size(); ++i) {
            const void *a = pairs[i].m_pProxy0->m_clientObject, *b = pairs[i].m_pProxy1->m_clientObject;
            if (a == &object) found.insert(static_cast<const btCollisionObject*>(b));
            if (b == &object) found.insert(static_cast<const btCollisionObject*>(a));
        }
        return found;
    }

    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher;
    std::unique_ptr<btBroadphaseInterface> broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
};

using MakeShape = std::function<std::unique_ptr<btCollisionShape>()>;

std::unique_ptr<btCollisionShape> plate() {
    return std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(0.02, 0.3, 0.3)));
}

const std::array<std::pair<std::string, MakeShape>, 5> targets{{
    {"mesh of a box", [] { return std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(0.1, 0.1, 0.1))); }},
    {"mesh of a table",
     [] {
         Mesh mesh = table_mesh();
         for (Vec3& v : mesh.vertices) v = {0.12 * v.x, 0.12 * v.y, 0.12 * v.z};
         return std::make_unique<bullet::MeshShape>(Shape::make(mesh));
     }},
    {"box", [] { return std::make_unique<btBoxShape>(btVector3(btScalar(0.05), btScalar(0.05), btScalar(0.05))); }},
    {"ball", [] { return std::make_unique<btSphereShape>(btScalar(0.05)); }},
    {"capsule", [] { return std::make_unique<btCapsuleShapeZ>(btScalar(0.03), btScalar(0.06)); }},
}};

struct Swing {
    double speed;     ///< m/s, along x
    double part;      ///< of a step's way that the hand begins farther back
    bool is_asleep;   ///< the body, before the hand comes
    int substeps = 1; ///< 1: the caller's steps are Bullet's
};

/// Whether the hand is beyond the body in the end.
bool passes(HandWorld& w, const MakeShape& target, const Swing& swing, const MakeShape& hand_shape = plate) {
    btRigidBody& body = w.add(target(), 0.2, at(0, 0.03, 0.05));
    double x = -1 - swing.part * swing.speed / 60;
    btRigidBody& hand = w.add(hand_shape(), 0, at(x, 0, 0.16), true);
    for (int i = 0; i < 300 && (swing.is_asleep ? body.isActive() : i < 30); ++i) w.step();
    EXPECT_EQ(!body.isActive(), swing.is_asleep);
    while (x < 1) {
        x += swing.speed / 60;
        hand.setWorldTransform(at(x, 0, 0.16));
        w.step();
    }
    return body.getWorldTransform().getOrigin().x() < hand.getWorldTransform().getOrigin().x();
}

int passes_of_ten(double speed, const MakeShape& target, bool is_asleep, const Settings& settings = {},
                  const MakeShape& hand_shape = plate) {
    int passed = 0;
    for (int i = 0; i < 10; ++i) {
        HandWorld w(std::make_unique<btDbvtBroadphase>(), settings);
        passed += passes(w, target, {speed, i / 10.0, is_asleep}, hand_shape) ? 1 : 0;
    }
    return passed;
}

TEST(Kinematic, AHandDoesNotPassWhatRests) {
    for (const auto& [name, target] : targets)
        for (const double speed : {2.0, 5.0, 10.0, 20.0})
            EXPECT_EQ(passes_of_ten(speed, target, false), 0) << name << " at " << speed << " m/s";
    Settings without;
    without.speculative = Speculative::off;
    EXPECT_GT(passes_of_ten(20, targets[0].second, false, without), 0) << "else nothing is shown";
}

TEST(Kinematic, ItWakesWhatSleeps) {
    for (const auto& [name, target] : targets)
        for (const double speed : {5.0, 20.0})
            EXPECT_EQ(passes_of_ten(speed, target, true), 0) << name << " at " << speed << " m/s";
}

// Pairs of two convex shapes are as Bullet has them.
TEST(Kinematic, AHandThatIsABoxOfBulletsPushesMeshes) {
    const MakeShape hand = [] {
        return std::make_unique<btBoxShape>(btVector3(btScalar(0.01), btScalar(0.15), btScalar(0.15)));
    };
    for (std::size_t i = 0; i < 2; ++i)
        for (const double speed : {5.0, 20.0})
            EXPECT_EQ(passes_of_ten(speed, targets[i].second, false, {}, hand), 0) << targets[i].first;
}

// It pushes the body aside.
TEST(Kinematic, AHandThatIsABallOfBulletsDoesNotGoThrough) {
    for (std::size_t i = 0; i < 2; ++i) {
        for (const double speed : {5.0, 20.0}) {
            for (int k = 0; k < 5; ++k) {
                HandWorld w;
                const btRigidBody& body = w.add(targets[i].second(), 0.2, at(0, 0.03, 0.05));
                double x = -1 - speed / 60 * k / 5;
                btRigidBody& hand = w.add(std::make_unique<btSphereShape>(btScalar(0.15)), 0, at(x, 0, 0.16), true);
                for (int j = 0; j < 10; ++j) w.step();
                btScalar nearest = 1;
                while (x < 1) {
                    x += speed / 60;
                    hand.setWorldTransform(at(x, 0, 0.16));
                    w.step();
                    const btVector3 between =
                        body.getWorldTransform().getOrigin() - hand.getWorldTransform().getOrigin();
                    nearest = btMin(nearest, between.length());
                }
                EXPECT_GT(double(nearest), 0.15) << targets[i].first << " at " << speed << " m/s, swing " << k;
                EXPECT_GT(double(body.getLinearVelocity().length()), 0.5) << targets[i].first;
            }
        }
    }
}

TEST(Kinematic, EveryBroadPhaseFindsWhatIsOnTheWay) {
    for (int kind = 0; kind < 4; ++kind) {
        for (const bool is_asleep : {false, true}) {
            for (int i = 0; i < 5; ++i) {
                std::unique_ptr<btBroadphaseInterface> broadphase = std::make_unique<btDbvtBroadphase>();
                if (kind == 1)
                    static_cast<btDbvtBroadphase&>(*broadphase).m_deferedcollide = true;
                else if (kind == 2)
                    broadphase = std::make_unique<bt32BitAxisSweep3>(btVector3(-50, -50, -50), btVector3(50, 50, 50));
                else if (kind == 3)
                    broadphase = std::make_unique<btSimpleBroadphase>();
                HandWorld w(std::move(broadphase));
                EXPECT_FALSE(passes(w, targets[0].second, {20, i / 5.0, is_asleep})) << kind << ' ' << i;
            }
        }
    }
}

// The next pose of a pile's bodies is solved in the same step, although Bullet's islands would wake one body alone.
TEST(Kinematic, ItWakesAPileInTime) {
    for (int i = 0; i < 5; ++i) {
        HandWorld w;
        std::array<btRigidBody*, 3> pile{};
        for (int k = 0; k < 3; ++k)
            pile[static_cast<std::size_t>(k)] = &w.add(targets[0].second(), 0.2, at(0, 0, 0.05 + 0.1 * k));
        double x = -1 - 0.333 * i / 5;
        btRigidBody& hand = w.add(plate(), 0, at(x, 0, 0.16), true);
        for (int k = 0; k < 300 && pile[0]->isActive(); ++k) w.step();
        ASSERT_FALSE(pile[0]->isActive());
        while (x < 0.6) {
            x += 20.0 / 60;
            hand.setWorldTransform(at(x, 0, 0.16));
            w.step();
        }
        for (const btRigidBody* body : pile) EXPECT_GT(double(body->getWorldTransform().getOrigin().x()), x) << i;
    }
}

// Far away it is not on its way there: what lies in between, or beyond, stays where it is.
TEST(Kinematic, WhatIsPutElsewhereSweepsNothing) {
    HandWorld w;
    const btRigidBody& between = w.add(targets[0].second(), 0.2, at(0, 0, 0.05));
    const btRigidBody& beyond = w.add(targets[0].second(), 0.2, at(9, 0, 0.05));
    btRigidBody& hand = w.add(plate(), 0, at(-5, 0, 0.16), true);
    for (int i = 0; i < 30; ++i) w.step();
    hand.setWorldTransform(at(5, 0, 0.16));
    w.step();
    EXPECT_LT(w.broadphase->getOverlappingPairCache()->getNumOverlappingPairs(), 5);
    for (int i = 0; i < 10; ++i) w.step();
    EXPECT_LT(double(between.getLinearVelocity().length()), 0.01);
    EXPECT_LT(double(beyond.getLinearVelocity().length()), 0.01);
}

// Filters are Bullet's, and so is a ghost's list of what overlaps it.
TEST(Kinematic, FiltersHoldOnTheWay) {
    btGhostPairCallback on_ghosts; // the world asks it to its end
    HandWorld w;
    w.broadphase->getOverlappingPairCache()->setInternalGhostPairCallback(&on_ghosts);
    btRigidBody& seen = w.add(targets[0].second(), 0.2, at(0, 0, 0.05));
    btRigidBody& filtered = w.add(targets[0].second(), 0.2, at(0, 0.12, 0.05));
    w.world.removeRigidBody(&filtered);
    w.world.addRigidBody(&filtered, btBroadphaseProxy::DebrisFilter, btBroadphaseProxy::StaticFilter);
    btGhostObject ghost;
    ghost.setCollisionShape(w.shapes[1].get());
    ghost.setCollisionFlags(ghost.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
    ghost.setWorldTransform(at(0, 0, 0.3));
    w.world.addCollisionObject(&ghost, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::AllFilter);
    btRigidBody& hand = w.add(plate(), 0, at(-1, 0, 0.16), true);
    w.world.removeRigidBody(&hand);
    w.world.addRigidBody(&hand, btBroadphaseProxy::KinematicFilter, btBroadphaseProxy::AllFilter);
    const double ways[] = {-0.67, -0.34};
    for (const double x : ways) {
        hand.setWorldTransform(at(x, 0, 0.16));
        w.step();
    }
    const auto partners = w.partners_of(hand);
    EXPECT_TRUE(partners.contains(&seen)) << "else nothing is shown";
    EXPECT_FALSE(partners.contains(&filtered));
    EXPECT_TRUE(partners.contains(&ghost));
    EXPECT_EQ(ghost.getNumOverlappingObjects() > 0, true);
    for (double x = 0; x < 1; x += 0.333) {
        hand.setWorldTransform(at(x, 0, 0.16));
        w.step();
    }
    EXPECT_LT(double(filtered.getWorldTransform().getOrigin().x()), 0.1);
    EXPECT_GT(double(seen.getWorldTransform().getOrigin().x()), 0.5);
    w.world.removeCollisionObject(&ghost);
}

/// With several of Bullet's substeps in a step the hand must move in each of them: see docs/bullet.md.
struct Driver {
    btRigidBody* hand;
    double x, speed;
    static void before(btDynamicsWorld* world, btScalar seconds) {
        auto& driver = *static_cast<Driver*>(world->getWorldUserInfo());
        driver.x += driver.speed * double(seconds);
        driver.hand->setWorldTransform(at(driver.x, 0, 0.16));
        driver.hand->saveKinematicState(seconds);
    }
};

TEST(Kinematic, AHandMovesInEverySubstep) {
    for (const double speed : {5.0, 20.0}) {
        for (int i = 0; i < 5; ++i) {
            HandWorld w;
            const btRigidBody& body = w.add(targets[0].second(), 0.2, at(0, 0, 0.05));
            Driver driver{nullptr, -1 - speed / 60 * i / 5, speed};
            driver.hand = &w.add(plate(), 0, at(driver.x, 0, 0.16), true);
            w.world.setInternalTickCallback(Driver::before, &driver, true);
            while (driver.x < 1) w.world.stepSimulation(dt, 8, dt / 4);
            EXPECT_GT(double(body.getWorldTransform().getOrigin().x()), driver.x) << speed << ' ' << i;
        }
    }
}

} // namespace
} // namespace raycontact::test
