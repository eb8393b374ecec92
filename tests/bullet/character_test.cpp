// SPDX-License-Identifier: Apache-2.0
// What asks about a pair cache of its own in the midst of a step, and queries: they have their answers, and change
// none.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletDynamics/Character/btKinematicCharacterController.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::test {
namespace {

const btVector3 upwards(0, 0, 1);

/// A world with a capsule, 1.8 m high, that walks as a btKinematicCharacterController.
struct Walk : TestWorld {
    explicit Walk(bool attached = true) {
        broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(&callback);
        if (attached) dispatcher.attach(world);
    }
    ~Walk() {
        if (character) {
            world.removeAction(&*character);
            world.removeCollisionObject(&ghost);
        }
        broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(nullptr); // it goes before the world
    }
    void add_character(const btVector3& place) {
        ghost.setWorldTransform(btTransform(btQuaternion::getIdentity(), place));
        ghost.setCollisionShape(&capsule);
        ghost.setCollisionFlags(btCollisionObject::CF_CHARACTER_OBJECT);
        character.emplace(&ghost, &capsule, btScalar(0.35), upwards);
        character->setGravity(btVector3(0, 0, btScalar(-9.81)));
        world.addCollisionObject(&ghost, btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::AllFilter);
        world.addAction(&*character);
    }
    btVector3 feet() const { return ghost.getWorldTransform().getOrigin() - btScalar(0.9) * upwards; }
    void walk(double speed, int steps_) {
        character->setWalkDirection(btVector3(btScalar(speed / 60), 0, 0));
        steps(steps_);
        character->setWalkDirection(btVector3(0, 0, 0));
    }

    btGhostPairCallback callback;
    btCapsuleShapeZ capsule{btScalar(0.4), 1};
    btPairCachingGhostObject ghost;
    std::optional<btKinematicCharacterController> character;
};

/// What each step told.
struct Told {
    std::vector<std::array<std::size_t, 3>> steps;
    std::vector<std::uint64_t> pairs;
    int begun = 0, ended = 0;
    void add(const bullet::CollisionDispatcher& d) {
        const bullet::DispatcherStats& s = d.stats();
        steps.push_back({d.begun().size(), d.ended().size(), s.touching});
        pairs.push_back(s.pairs);
        begun += static_cast<int>(d.begun().size());
        ended += static_cast<int>(d.ended().size());
    }
};

/// Nine bodies fall, each by itself, and the balls bounce: no order of manifolds shows. disturb: once a step.
Told fall(Walk& w, const std::function<void()>& disturb) {
    w.add_mesh(Shape::make(box_mesh(20, 20, 1)), 0, at(0, 0, -0.5)).setRestitution(1);
    for (int i = 0; i < 9; ++i) {
        btRigidBody* body = nullptr;
        const btTransform pose = at(2 * (i % 3) - 2, 2 * (i / 3) - 2, 0.6 + 0.1 * i);
        if (i % 3 == 0)
            body = &w.add_mesh(table(), 3, pose);
        else if (i % 3 == 1)
            body = &w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, pose);
        else
            body =
                &w.add(std::make_unique<btBoxShape>(btVector3(btScalar(0.2), btScalar(0.2), btScalar(0.2))), 1, pose);
        if (i % 3 == 1) body->setRestitution(btScalar(0.8)); // each time it is told
    }
    Told told;
    for (int i = 0; i < 150; ++i) {
        w.steps(1);
        if (disturb) disturb();
        told.add(w.dispatcher);
    }
    return told;
}

// It stands on one of Bullet's boxes: its own pairs of the world are none of ours.
TEST(Characters, OneElsewhereChangesNothing) {
    for (const bool attached : {true, false}) {
        Walk without(attached), with(attached);
        const Told expected = fall(without, {});
        ASSERT_GE(expected.begun, 15);
        ASSERT_GE(expected.ended, 6);
        with.add(std::make_unique<btBoxShape>(btVector3(1, 1, 1)), 0, at(-30, 0, -1));
        with.add_character(btVector3(-30, 0, btScalar(0.92)));
        const Told found = fall(with, {});
        EXPECT_EQ(found.steps, expected.steps) << attached;
        for (std::size_t i = 0; i < expected.pairs.size(); ++i) // Bullet drops pairs that part a little at a time
            EXPECT_NEAR(double(found.pairs[i]), double(expected.pairs[i]), 2) << "step " << i << ", " << attached;
        EXPECT_NEAR(double(with.feet().z()), 0, 0.05);
    }
}

// Each in each step, of all kinds of pairs that the world has.
TEST(Characters, QueriesChangeNothing) {
    Walk plain, asked;
    const Told expected = fall(plain, {});
    btHashedOverlappingPairCache own;
    Count count;
    const Told found = fall(asked, [&] {
        asked.world.contactTest(asked.bodies[0].get(), count);
        for (std::size_t i = 1; i < asked.bodies.size(); ++i) {
            asked.world.contactPairTest(asked.bodies[0].get(), asked.bodies[i].get(), count);
            own.addOverlappingPair(asked.bodies[0]->getBroadphaseProxy(), asked.bodies[i]->getBroadphaseProxy());
        }
        asked.dispatcher.dispatchAllCollisionPairs(&own, asked.world.getDispatchInfo(), &asked.dispatcher);
    });
    for (const auto& body : asked.bodies)
        own.removeOverlappingPairsContainingProxy(body->getBroadphaseProxy(), &asked.dispatcher);
    EXPECT_GT(count.points, 100);
    EXPECT_EQ(found.steps, expected.steps);
    EXPECT_EQ(found.pairs, expected.pairs);
}

using Add = std::function<void(Walk&)>;

/// A floor from x = -4 to 4 at z = 0, a step of 0.2 m from x = 1 on, and a wall at x = 3.
Mesh course() {
    Mesh mesh;
    mesh.name = "course";
    const double profile[][2] = {{-4, 0}, {1, 0}, {1, 0.2}, {3, 0.2}, {3, 3}};
    for (const auto& [x, z] : profile) mesh.vertices.insert(mesh.vertices.end(), {{x, -3, z}, {x, 3, z}});
    for (std::uint32_t i = 0; i < 8; i += 2) {
        mesh.triangles.push_back({i, i + 2, i + 3});
        mesh.triangles.push_back({i, i + 3, i + 1});
    }
    return mesh;
}

const std::vector<std::pair<std::string, Add>> courses{
    {"closed meshes",
     [](Walk& w) {
         w.add_mesh(Shape::make(box_mesh(5, 6, 1)), 0, at(-1.5, 0, -0.5));
         w.add_mesh(Shape::make(box_mesh(2, 6, 1)), 0, at(2, 0, -0.3));
         w.add_mesh(Shape::make(box_mesh(1, 6, 4)), 0, at(3.5, 0, 1));
     }},
    {"open mesh", [](Walk& w) { w.add_mesh(Shape::make(course()), 0, at(0, 0, 0)); }},
    {"Bullet's mesh",
     [](Walk& w) {
         const Mesh mesh = course();
         static btTriangleMesh triangles;
         triangles = btTriangleMesh();
         for (const auto& t : mesh.triangles) {
             const auto corner = [&](int k) {
                 const Vec3& v = mesh.vertices[t[static_cast<std::size_t>(k)]];
                 return btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z));
             };
             triangles.addTriangle(corner(0), corner(1), corner(2));
         }
         w.add(std::make_unique<btBvhTriangleMeshShape>(&triangles, true), 0, at(0, 0, 0));
     }},
};

TEST(Characters, WalksClimbsAndStops) {
    for (const auto& [name, add] : courses) {
        Walk w;
        add(w);
        w.add_character(btVector3(-2, btScalar(0.1), 1));
        w.steps(60);
        EXPECT_TRUE(w.character->onGround()) << name;
        EXPECT_NEAR(double(w.feet().z()), 0, 0.06) << name;
        EXPECT_NEAR(double(w.feet().x()), -2, 0.02) << name;
        w.walk(2, 60);
        EXPECT_NEAR(double(w.feet().x()), 0, 0.1) << name;
        EXPECT_NEAR(double(w.feet().z()), 0, 0.06) << name;
        w.walk(2, 60);
        EXPECT_NEAR(double(w.feet().z()), 0.2, 0.06) << name;
        EXPECT_GT(double(w.feet().x()), 1.5) << name;
        w.walk(2, 90);
        EXPECT_LT(double(w.feet().x()), 2.65) << name << ": the wall is at 3, its radius 0.4";
        EXPECT_GT(double(w.feet().x()), 2.5) << name;
        w.walk(-2, 240);
        EXPECT_LT(double(w.feet().z()), -1) << name << ": off the floor's end";
    }
}

// Pushed into a mesh, it is pushed out by the manifolds of its own pairs.
TEST(Characters, IsPushedOutOfAMesh) {
    for (const auto& [name, add] : courses) {
        Walk w;
        add(w);
        w.add_character(btVector3(-2, 0, btScalar(0.82)));
        w.steps(30);
        EXPECT_NEAR(double(w.feet().z()), 0, 0.06) << name;
    }
}

/// Points of the ghost's own pairs that are deeper than `depth`, and whether all of their normals look up.
std::pair<int, bool> deep_points(btPairCachingGhostObject& ghost, double depth) {
    int points = 0;
    bool up = true;
    btBroadphasePairArray& pairs = ghost.getOverlappingPairCache()->getOverlappingPairArray();
    for (int i = 0; i < pairs.size(); ++i) {
        if (!pairs[i].m_algorithm) continue;
        btManifoldArray manifolds;
        pairs[i].m_algorithm->getAllContactManifolds(manifolds);
        for (int m = 0; m < manifolds.size(); ++m)
            for (int k = 0; k < manifolds[m]->getNumContacts(); ++k) {
                const btManifoldPoint& p = manifolds[m]->getContactPoint(k);
                if (double(p.getDistance()) > -depth) continue;
                ++points;
                const btScalar sign = manifolds[m]->getBody0() == &ghost ? btScalar(1) : btScalar(-1);
                up = up && sign * p.m_normalWorldOnB.z() > btScalar(0.99);
            }
    }
    return {points, up};
}

TEST(Characters, AGhostsOwnPairsHaveTheirPoints) {
    const auto half = btScalar(0.3);
    const std::vector<std::pair<std::string, std::shared_ptr<btCollisionShape>>> shapes{
        {"ball", std::make_shared<btSphereShape>(half)},
        {"capsule", std::make_shared<btCapsuleShapeX>(half, half)},
        {"box", std::make_shared<btBoxShape>(btVector3(half, half, half))},
        {"cylinder", std::make_shared<btCylinderShapeZ>(btVector3(half, half, half))},
        {"mesh", std::make_shared<bullet::MeshShape>(Shape::make(box_mesh(0.6, 0.6, 0.6)))}};
    static const std::vector<float> heights(17 * 17, 0);
    for (const std::string ground : {"closed", "open", "field"})
        for (const auto& [name, shape] : shapes) {
            Walk w;
            if (ground == "closed") w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
            if (ground == "open") courses[2].second(w);
            if (ground == "field")
                w.add(std::make_unique<btHeightfieldTerrainShape>(17, 17, heights.data(), btScalar(1), btScalar(-1),
                                                                  btScalar(1), 2, PHY_FLOAT, false),
                      0, at(0, 0, 0));
            btPairCachingGhostObject ghost;
            ghost.setCollisionShape(shape.get());
            ghost.setWorldTransform(at(-2.1, 0.13, 0.29));
            ghost.setCollisionFlags(btCollisionObject::CF_NO_CONTACT_RESPONSE);
            w.world.addCollisionObject(&ghost, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
            w.world.performDiscreteCollisionDetection();
            const auto ask = [&] {
                w.dispatcher.dispatchAllCollisionPairs(ghost.getOverlappingPairCache(), w.world.getDispatchInfo(),
                                                       &w.dispatcher);
            };
            for (int again = 0; again < 3; ++again) {
                ask();
                const auto [points, up] = deep_points(ghost, 0.005);
                EXPECT_GE(points, 1) << name << " on " << ground;
                EXPECT_LE(points, 4) << name << " on " << ground;
                EXPECT_TRUE(up) << name << " on " << ground;
            }
            ghost.setWorldTransform(at(-2.1, 0.13, 0.4)); // its pairs stay: boxes are updated in steps
            ask();
            EXPECT_EQ(deep_points(ghost, -1).first, 0) << name << " on " << ground << ": stale points";
            w.world.removeCollisionObject(&ghost);
        }
}

int started, over; // callbacks have no state

TEST(Characters, AGhostsOwnPairStartsAndEndsOnce) {
    Walk w;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btPairCachingGhostObject ghost;
    btSphereShape ball(btScalar(0.3));
    ghost.setCollisionShape(&ball);
    ghost.setWorldTransform(at(0, 0, 0.29));
    w.world.addCollisionObject(&ghost, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
    w.world.performDiscreteCollisionDetection();
    started = over = 0;
    gContactStartedCallback = [](btPersistentManifold* const&) { ++started; };
    gContactEndedCallback = [](btPersistentManifold* const&) { ++over; };
    for (const double height : {0.29, 0.285, 0.28, 0.4}) {
        ghost.setWorldTransform(at(0.01, 0.02, height));
        w.dispatcher.dispatchAllCollisionPairs(ghost.getOverlappingPairCache(), w.world.getDispatchInfo(),
                                               &w.dispatcher);
        EXPECT_EQ(started, 1) << height;
        EXPECT_EQ(over, height < 0.3 ? 0 : 1) << height;
    }
    gContactStartedCallback = nullptr;
    gContactEndedCallback = nullptr;
    w.world.removeCollisionObject(&ghost);
}

/// Four wheels under a box; gives where it is after a second of rest and three of driving.
btVector3 drive(const std::function<void(TestWorld&)>& add_ground, std::uint64_t* pairs = nullptr) {
    TestWorld w;
    add_ground(w);
    auto chassis = std::make_unique<btCompoundShape>();
    chassis->addChildShape(
        at(0, 0, 0.4), &w.keep(std::make_unique<btBoxShape>(btVector3(btScalar(0.8), btScalar(0.5), btScalar(0.2)))));
    btRigidBody& car = w.add(std::move(chassis), 400, at(-8, 0, 0.6));
    btDefaultVehicleRaycaster rays(&w.world);
    const btRaycastVehicle::btVehicleTuning tuning;
    btRaycastVehicle vehicle(tuning, &car, &rays);
    vehicle.setCoordinateSystem(1, 2, 0);
    for (const double x : {-0.7, 0.7})
        for (const double y : {-0.5, 0.5}) {
            btWheelInfo& wheel =
                vehicle.addWheel(btVector3(btScalar(x), btScalar(y), btScalar(0.3)), btVector3(0, 0, -1),
                                 btVector3(0, 1, 0), btScalar(0.3), btScalar(0.25), tuning, x > 0);
            wheel.m_suspensionStiffness = 40;
            wheel.m_wheelsDampingRelaxation = 5, wheel.m_wheelsDampingCompression = 4;
        }
    w.world.addAction(&vehicle);
    bullet::recommend(w.world);
    w.steps(60);
    for (int i = 0; i < vehicle.getNumWheels(); ++i) {
        EXPECT_TRUE(vehicle.getWheelInfo(i).m_raycastInfo.m_isInContact) << i;
        if (i > 1) vehicle.applyEngineForce(-300, i);
    }
    w.steps(180);
    if (pairs) *pairs = w.dispatcher.stats().pairs;
    const btVector3 place = car.getWorldTransform().getOrigin();
    w.world.removeAction(&vehicle);
    return place;
}

TEST(Characters, AVehicleDrivesOnAMeshAsOnABox) {
    const btVector3 on_box = drive(
        [](TestWorld& w) { w.add(std::make_unique<btBoxShape>(btVector3(40, 10, btScalar(0.5))), 0, at(0, 0, -0.5)); });
    ASSERT_GT(double(on_box.x()), -5) << "else nothing is shown";
    std::uint64_t pairs = 0;
    const btVector3 on_mesh =
        drive([](TestWorld& w) { w.add_mesh(Shape::make(box_mesh(80, 20, 1)), 0, at(0, 0, -0.5)); }, &pairs);
    EXPECT_LT(double((on_mesh - on_box).length()), 0.01);
    EXPECT_EQ(pairs, 0u) << "nothing but its rays comes near";
}

} // namespace
} // namespace raycontact::test
