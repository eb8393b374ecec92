// SPDX-License-Identifier: Apache-2.0
// Transforms, speeds and meshes that cannot be used: none ends a simulation, and each is told once.
#include "test_world.h"

#include <faults.h>
#include <placement.h>

#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace raycontact::test {
namespace {

constexpr btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();

std::unique_ptr<btTriangleMesh> triangle(const btVector3& a, const btVector3& b, const btVector3& c) {
    auto mesh = std::make_unique<btTriangleMesh>();
    mesh->addTriangle(a, b, c);
    return mesh;
}

/// The faults that were told.
struct Told {
    explicit Told(TestWorld& world) {
        world.dispatcher.on_fault([this](const bullet::Fault& fault) { faults.push_back(fault); });
    }
    std::vector<bullet::Fault> faults;
};

/// Without new boxes: Bullet moves no box that is not finite, so the pairs stay.
void dispatch(TestWorld& w) {
    w.dispatcher.dispatchAllCollisionPairs(w.world.getPairCache(), w.world.getDispatchInfo(), &w.dispatcher);
}

TEST(BulletFaults, WhatCannotBePlacedIsLeftOutAndNamed) {
    TestWorld w;
    Told told(w);
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.4));
    body.setUserIndex(42);
    w.steps(30);
    ASSERT_GT(w.touching(), 0);
    for (const btMatrix3x3& basis : {diagonal(1, 0, 1), diagonal(double(nan), 1, 1)}) {
        told.faults.clear();
        const btTransform before = body.getWorldTransform();
        body.setWorldTransform(btTransform(basis, before.getOrigin()));
        for (int i = 0; i < 3; ++i) {
            dispatch(w);
            EXPECT_EQ(w.dispatcher.stats().left_out, std::vector<const btCollisionObject*>{&body});
            EXPECT_EQ(w.touching(), 0);
        }
        ASSERT_EQ(told.faults.size(), 1u);
        EXPECT_EQ(told.faults[0].object, &body);
        EXPECT_NE(told.faults[0].text.find("user index 42"), std::string::npos) << told.faults[0].text;
        EXPECT_THROW(w.dispatcher.add_body(body), bullet::ObjectError);
        body.setWorldTransform(before);
        w.world.performDiscreteCollisionDetection();
        EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
        EXPECT_GT(w.touching(), 0);
    }
}

std::string fault_of(const btMatrix3x3& basis) {
    try {
        bullet::place(btTransform(basis, {0, 0, 0}));
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(BulletFaults, FaultsSayWhatIsWrong) {
    for (const btMatrix3x3& flat : {diagonal(0, 1, 1), diagonal(0, 0, 0), diagonal(-1, 0, 1), diagonal(1e-10, 1, 1)}) {
        EXPECT_NE(fault_of(flat).find("flat"), std::string::npos) << fault_of(flat);
        EXPECT_EQ(fault_of(flat).find("mirrored"), std::string::npos) << fault_of(flat); // it may be
        EXPECT_EQ(fault_of(flat).find("rotation"), std::string::npos) << fault_of(flat);
    }
    EXPECT_NE(fault_of(diagonal(1, double(nan), 1)).find("not a finite number"), std::string::npos);
    // Mirrored and small: the determinant is none of float's numbers.
    EXPECT_EQ(fault_of(diagonal(-1e-16, 1e-16, 1e-16)), "");
}

TEST(BulletFaults, MeshesOfWhichNoneCanBeMadeAreLeftOutAndNamed) {
    const auto flat = triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    const auto point = triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    const auto far = triangle({0, 0, 0}, {btScalar(3e9), 0, 0}, {0, btScalar(3e9), 0});
    for (const auto* mesh : {&flat, &point, &far}) {
        TestWorld w;
        Told told(w);
        btRigidBody& bad = w.add(std::make_unique<btBvhTriangleMeshShape>(mesh->get(), false), 0, at(0, 0, 0));
        w.add_mesh(table(), 5, at(0.5, 0, 0.35));
        w.steps(5);
        ASSERT_EQ(told.faults.size(), 1u);
        EXPECT_EQ(told.faults[0].object, &bad);
        EXPECT_EQ(w.dispatcher.stats().left_out, std::vector<const btCollisionObject*>{&bad});
        try {
            w.dispatcher.add_body(bad);
            FAIL() << "it was added";
        } catch (const bullet::ObjectError& error) {
            EXPECT_EQ(error.fault().object, &bad);
        }
    }
}

TEST(BulletFaults, QueriesTakeThemToo) {
    TestWorld w;
    Told told(w);
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& high = w.add_mesh(Shape::make(box_mesh(1, 1, 1)), 0, at(0, 0, 1.5));
    const auto points = [&] {
        Count count;
        w.world.contactPairTest(&low, &high, count);
        return count.points;
    };
    EXPECT_EQ(points(), 0);
    high.setWorldTransform(btTransform(diagonal(1, 1, 4), {0, 0, btScalar(1.5)})); // down to -0.5
    EXPECT_GT(points(), 0);
    high.setWorldTransform(btTransform(diagonal(1, 1, 0), {0, 0, 0}));
    EXPECT_EQ(points(), 0);
    EXPECT_EQ(points(), 0);
    ASSERT_EQ(told.faults.size(), 1u);
    EXPECT_EQ(told.faults[0].object, &high);
}

/// Two tables in one object, side by side; a third lies on the right one.
struct TwoChildren {
    explicit TwoChildren(TestWorld& w) : table_shape(w.keep(std::make_unique<bullet::MeshShape>(table()))) {
        auto made = std::make_unique<btCompoundShape>();
        compound = made.get();
        for (const double x : {0.0, 3.0}) compound->addChildShape(at(x, 0, 0), &table_shape);
        object = &w.add(std::move(made), 0, at(0, 0, 0));
        w.add_mesh(table(), 1, at(3, 0, 0.79));
    }
    bullet::MeshShape& table_shape;
    btCompoundShape* compound;
    btRigidBody* object;
};

// Points are held for some steps, and manifolds of Bullet's own algorithms until these run again.
TEST(BulletFaults, AChildThatIsLeftOutLosesItsManifoldsAtOnce) {
    TestWorld w;
    w.dispatcher.on_fault({});
    const auto squeezed = diagonal(1, 1, 1e-5);
    auto compound = std::make_unique<btCompoundShape>();
    compound->addChildShape(btTransform(squeezed, btVector3(3, 0, btScalar(-0.5))),
                            &w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(2, 2, 1e5)))));
    btRigidBody& object = w.add(std::move(compound), 1, at(0, 0, 0));
    w.add_mesh(table(), 0, at(3, 0, 0.39));
    w.world.performDiscreteCollisionDetection();
    ASSERT_TRUE(w.dispatcher.stats().left_out.empty());
    ASSERT_GT(w.touching(), 0);
    object.setWorldTransform(btTransform(squeezed, btVector3(0, 0, 0))); // squeezed twice it is flat
    dispatch(w);
    ASSERT_EQ(w.dispatcher.stats().left_out.size(), 1u);
    EXPECT_EQ(w.touching(), 0);
}

TEST(BulletFaults, EachChildsIsToldAgainWhenItComesBack) {
    TestWorld w;
    Told told(w);
    TwoChildren two(w);
    w.world.performDiscreteCollisionDetection();
    const auto set = [&](int child, btScalar z) {
        two.compound->getChildList()[child].m_transform.getBasis()[2][2] = z;
        told.faults.clear();
        dispatch(w);
        dispatch(w);
    };
    set(0, 0);
    ASSERT_EQ(told.faults.size(), 1u);
    set(1, 0);
    ASSERT_EQ(told.faults.size(), 1u);
    EXPECT_EQ(told.faults[0].child, 1);
    set(1, 1);
    EXPECT_TRUE(told.faults.empty());
    set(1, 0);
    ASSERT_EQ(told.faults.size(), 1u) << "the other child was bad all the while";
    EXPECT_EQ(told.faults[0].child, 1);
}

TEST(BulletFaults, AddBodyThrowsEachTimeAndNothingIsToldTwice) {
    const auto flat = triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    TestWorld w;
    Told told(w);
    const btRigidBody& bad = w.add(std::make_unique<btBvhTriangleMeshShape>(flat.get(), false), 0, at(0, 0, 0));
    btRigidBody& body = w.add_mesh(table(), 5, at(0.5, 0, 0.35));
    w.world.performDiscreteCollisionDetection(); // both are in use
    EXPECT_EQ(told.faults.size(), 1u);
    const btTransform pose = body.getWorldTransform();
    body.setWorldTransform(btTransform(diagonal(1, 1, 0), pose.getOrigin()));
    for (int i = 0; i < 3; ++i) {
        for (const btRigidBody* one : {&bad, static_cast<const btRigidBody*>(&body)}) {
            for (int k = 0; k < 2; ++k) {
                try {
                    w.dispatcher.add_body(*one);
                    FAIL() << "it was added";
                } catch (const bullet::ObjectError& error) {
                    EXPECT_EQ(error.fault().object, one);
                    EXPECT_NE(error.fault().text.find("it has no contacts"), std::string::npos);
                }
            }
        }
        dispatch(w);
    }
    EXPECT_EQ(told.faults.size(), 2u);
    body.setWorldTransform(pose); // mended, it is taken without another dispatch
    EXPECT_NO_THROW(w.dispatcher.add_body(body));
    w.dispatcher.remove_body(body);
}

TEST(BulletFaults, NoneIsLostWhenTheCallbackThrowsOrPutsAnotherInItsPlace) {
    const auto flat = triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    TestWorld w;
    for (int i = 0; i < 4; ++i)
        w.add(std::make_unique<btBvhTriangleMeshShape>(flat.get(), false), 0, at(0, 0, 0)).setUserIndex(i);
    w.add_mesh(table(), 5, at(0.5, 0, 0.35));
    std::vector<int> told;
    const std::vector<int> large(1000, 7); // in the callback's own memory, which must outlive the call
    w.dispatcher.on_fault([&, large](const bullet::Fault& fault) {
        told.push_back(fault.object->getUserIndex());
        w.dispatcher.on_fault([&](const bullet::Fault& other) { told.push_back(other.object->getUserIndex()); });
        EXPECT_EQ(large.back(), 7);
        throw InputError("the user's");
    });
    EXPECT_THROW(w.world.performDiscreteCollisionDetection(), InputError);
    EXPECT_EQ(told.size(), 1u);
    dispatch(w);
    std::ranges::sort(told);
    EXPECT_EQ(told, (std::vector{0, 1, 2, 3}));
}

TEST(BulletFaults, AnotherObjectAtTheSameAddressIsToldOf) {
    const auto flat = triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    const btBvhTriangleMeshShape bad(flat.get(), false);
    TestWorld w;
    Told told(w);
    const auto meet = [&] {
        btCollisionObject object; // at one address each time
        object.setCollisionShape(const_cast<btBvhTriangleMeshShape*>(&bad));
        w.world.addCollisionObject(&object);
        w.world.performDiscreteCollisionDetection();
        w.world.removeCollisionObject(&object);
        w.dispatcher.remove_body(object);
    };
    w.add_mesh(table(), 5, at(0.5, 0, 0.35));
    meet();
    meet();
    EXPECT_EQ(told.faults.size(), 2u);
}

TEST(BulletFaults, OneThatIsAddedAgainIsToldOfAgain) {
    const auto flat = triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    const btBvhTriangleMeshShape bad(flat.get(), false);
    TestWorld w;
    Told told(w);
    btRigidBody& body = w.add_mesh(table(), 5, at(0.5, 0, 0.35));
    for (std::size_t i = 1; i <= 3; ++i) {
        btCollisionObject object; // at one address each time
        object.setCollisionShape(const_cast<btBvhTriangleMeshShape*>(&bad));
        w.world.addCollisionObject(&object);
        for (int k = 0; k < 4; ++k) { // it meets nothing in between, which is no reason to tell it again
            w.world.performDiscreteCollisionDetection();
            EXPECT_EQ(w.dispatcher.stats().left_out.size(), 1u);
            w.world.removeRigidBody(&body);
            w.world.performDiscreteCollisionDetection();
            EXPECT_EQ(w.dispatcher.stats().left_out.size(), 0u);
            w.world.addRigidBody(&body);
        }
        w.world.removeCollisionObject(&object); // without remove_body
        EXPECT_EQ(told.faults.size(), i);
    }
}

TEST(BulletFaults, ObjectsThatAreGoneForLongAreForgotten) {
    bullet::Faults faults;
    int told = 0;
    faults.set_callback([&](const bullet::Fault&) { ++told; });
    const btBoxShape box(btVector3(1, 1, 1));
    btCollisionObject gone, used;
    for (btCollisionObject* object : {&gone, &used}) object->setCollisionShape(const_cast<btBoxShape*>(&box));
    const auto find = [&] {
        for (const btCollisionObject* object : {&gone, &used}) faults.add(bullet::fault_of(*object, 0, "bad"));
        faults.tell();
    };
    find();
    find();
    EXPECT_EQ(told, 2);
    for (int i = 0; i < 1000; ++i) faults.sweep([&](const btCollisionObject* object) { return object == &used; });
    find();
    EXPECT_EQ(told, 3);
}

// A speed beyond all bounds makes a pose that is not finite; speculative contacts ask for it before Bullet does. One
// that is no number would make those of all that touch it no numbers, in Bullet's solver.
TEST(BulletFaults, NoSpeedEndsASimulation) {
    TestWorld w;
    w.dispatcher.on_fault({});
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.4));
    for (const btScalar speed : {btScalar(1e30), btScalar(INFINITY), nan}) {
        body.setWorldTransform(at(0, 0, 0.4));
        body.setLinearVelocity(btVector3(0, 0, speed));
        w.world.performDiscreteCollisionDetection();
        const bool is_left_out = !w.dispatcher.stats().left_out.empty();
        EXPECT_EQ(is_left_out, !std::isfinite(speed)) << speed;
        EXPECT_EQ(w.dispatcher.stats().contacts == 0, is_left_out) << speed;
    }
}

/// A body that may be disabled, at rest on a static mesh.
btRigidBody& add_resting(TestWorld& w) {
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.4));
    body.forceActivationState(ACTIVE_TAG);
    w.steps(10);
    EXPECT_GT(w.touching(), 0);
    return body;
}

// Bullet disables such a body in the next update of its boxes, and asks for none of its pairs any more.
TEST(BulletFaults, ABodyThatBulletDisablesIsReported) {
    for (const bool attached : {false, true}) {
        for (const bool by_velocity : {false, true}) {
            TestWorld w;
            if (attached) w.dispatcher.attach(w.world);
            btRigidBody& body = add_resting(w);
            Told told(w);
            if (by_velocity)
                body.setLinearVelocity(btVector3(nan, 0, 0));
            else
                body.getWorldTransform().getOrigin().setX(nan);
            for (int i = 0; i < 5; ++i) {
                w.steps(1);
                EXPECT_EQ(w.dispatcher.stats().left_out, std::vector<const btCollisionObject*>{&body});
            }
            ASSERT_EQ(told.faults.size(), 1u) << attached << by_velocity;
            EXPECT_EQ(told.faults[0].object, &body);
            EXPECT_TRUE(told.faults[0].left_out);
            EXPECT_NE(told.faults[0].text.find(by_velocity ? "velocity is not finite" : "finite"), std::string::npos)
                << told.faults[0].text;
            EXPECT_FALSE(body.isActive()) << "Bullet's part";

            body.setCenterOfMassTransform(at(0, 0, 0.4));
            body.setInterpolationWorldTransform(at(0, 0, 0.4));
            body.setLinearVelocity(btVector3(0, 0, 0));
            body.setAngularVelocity(btVector3(0, 0, 0));
            body.setInterpolationLinearVelocity(btVector3(0, 0, 0));
            body.setInterpolationAngularVelocity(btVector3(0, 0, 0));
            body.clearForces();
            body.forceActivationState(ACTIVE_TAG);
            w.steps(60);
            EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
            EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.005);
            body.getWorldTransform().getOrigin().setX(nan);
            w.steps(2);
            EXPECT_EQ(told.faults.size(), 2u) << "mended, and broken again";
        }
    }
}

// It is in no pair, so only a dispatcher that knows its world sees it.
TEST(BulletFaults, ABodyInTheAirIsReportedInAnAttachedWorld) {
    for (const bool mesh : {true, false}) {
        TestWorld w;
        w.dispatcher.attach(w.world);
        add_resting(w);
        Told told(w);
        btRigidBody& body = mesh ? w.add_mesh(table(), 5, at(0, 0, 9))
                                 : w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, at(0, 0, 9));
        body.forceActivationState(ACTIVE_TAG);
        w.steps(1);
        body.setLinearVelocity(btVector3(0, nan, 0));
        w.steps(3);
        EXPECT_EQ(w.dispatcher.stats().left_out, std::vector<const btCollisionObject*>{&body});
        ASSERT_EQ(told.faults.size(), 1u);
        EXPECT_EQ(told.faults[0].object, &body);
        w.remove(body);
        w.steps(2);
        EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
    }
}

} // namespace
} // namespace raycontact::test
