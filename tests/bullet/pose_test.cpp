// SPDX-License-Identifier: Apache-2.0
// Transforms that Bullet takes although they are not rigid, and meshes without an area: none ends a simulation.
#include "test_world.h"

#include <faults.h>
#include <placement.h>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace raycontact::test {
namespace {

constexpr btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();

btTransform with_basis(const btMatrix3x3& basis, const btVector3& origin) {
    return btTransform(basis, origin);
}

btMatrix3x3 diagonal(double x, double y, double z) {
    return btMatrix3x3(btScalar(x), 0, 0, 0, btScalar(y), 0, 0, 0, btScalar(z));
}

btMatrix3x3 turned(double angle) {
    return btMatrix3x3(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(angle)));
}

/// Rounded as a product of float matrices is, also in a Bullet in double precision.
btMatrix3x3 in_float(const btMatrix3x3& m) {
    btMatrix3x3 rounded;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) rounded[i][j] = btScalar(float(m[i][j]));
    return rounded;
}

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

TEST(BulletPose, ABasisThatDriftsIsMadeRigid) {
    TestWorld w;
    btRigidBody& wheel = w.add_mesh(torus(), 0, at(0, 0, 0));
    wheel.setCollisionFlags(wheel.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    w.add_mesh(Shape::make(box_mesh(1, 1, 0.2)), 1, at(0.4, 0, 0));
    const btMatrix3x3 turn = in_float(turned(0.01));
    std::uint64_t mended = 0;
    for (int i = 0; i < 12000; ++i) {
        btTransform pose = wheel.getWorldTransform();
        pose.setBasis(in_float(pose.getBasis() * turn));
        wheel.setWorldTransform(pose);
        if (i % 10 == 0) w.world.performDiscreteCollisionDetection();
        ASSERT_TRUE(w.dispatcher.stats().left_out.empty()) << i;
        ASSERT_EQ(w.dispatcher.stats().scaled, 0u) << i;
        mended += w.dispatcher.stats().made_rigid;
    }
    EXPECT_GT(mended, 1000u);
    EXPECT_GT(w.dispatcher.stats().contacts, 0u);
}

TEST(BulletPose, DriftScaleAndWhatCannotBeUsed) {
    const btVector3 origin(1, 2, 3);
    EXPECT_FALSE(bullet::place(with_basis(turned(1), origin)).drifted);
    for (const double off : {1e-4, 5e-4}) {
        const auto placed = bullet::place(with_basis(turned(1) * diagonal(1, 1 + off, 1), origin));
        EXPECT_TRUE(placed.drifted);
        EXPECT_EQ(placed.stretch, bullet::no_stretch);
        EXPECT_EQ(placed.pose.getOrigin(), origin);
        EXPECT_FALSE(bullet::place(placed.pose).drifted);
    }
    const btMatrix3x3 shear(1, btScalar(0.5), 0, 0, 1, 0, 0, 0, 1);
    for (const btMatrix3x3& basis : {diagonal(1.01, 1.01, 1.01), diagonal(2.5, 2.5, 2.5), diagonal(0.01, 0.01, 0.01),
                                     diagonal(1, 2, 30), diagonal(-1, 1, 1), diagonal(-3, -3, -3), shear}) {
        const btMatrix3x3 given = turned(1) * basis;
        const auto placed = bullet::place(with_basis(given, origin));
        EXPECT_FALSE(placed.drifted);
        EXPECT_FALSE(bullet::place(placed.pose).drifted);
        btScalar largest = 0;
        for (int i = 0; i < 3; ++i) largest = btMax(largest, given[i].absolute()[given[i].absolute().maxAxis()]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                btScalar product = 0;
                for (int k = 0; k < 3; ++k)
                    product += placed.pose.getBasis()[i][k] * btScalar(placed.stretch[3 * k + j]);
                EXPECT_NEAR(double(product), double(given[i][j]), 2e-3 * double(largest)) << i << j;
            }
    }
    const btMatrix3x3 unturned = btMatrix3x3::getIdentity();
    EXPECT_THROW(bullet::place(with_basis(unturned, btVector3(0, nan, 0))), InputError);
    EXPECT_THROW(bullet::place(with_basis(diagonal(1, double(nan), 1), origin)), InputError);
    EXPECT_THROW(bullet::place(with_basis(diagonal(0, 1, 1), origin)), InputError);
    EXPECT_THROW(bullet::place(with_basis(diagonal(0, 0, 0), origin)), InputError);
    EXPECT_THROW(bullet::place(with_basis(diagonal(1, 1, double(INFINITY)), origin)), InputError);
}

// Fresh rotations by a scale that lies between two steps: the last bits of each decide to which it is rounded.
TEST(BulletPose, AScaleBetweenTwoStepsMakesOneMesh) {
    TestWorld w;
    btRigidBody& wheel = w.add_mesh(torus(), 0, at(0, 0, 0));
    wheel.setCollisionFlags(wheel.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    btRigidBody& rod = w.add_mesh(Shape::make(box_mesh(3, 0.2, 0.2)), 1, at(0, 0, 0));
    std::uint64_t made = 0, changes = 0;
    const double scale = 1 + 1.5 / 1024;
    for (int i = 0; i < 1000; ++i) {
        wheel.setWorldTransform(with_basis(in_float(turned(0.01 * i) * diagonal(scale, scale, scale)), {0, 0, 0}));
        w.world.performDiscreteCollisionDetection();
        made += w.dispatcher.stats().shapes_made;
        ASSERT_GT(w.dispatcher.stats().points, 0u);
        changes += w.dispatcher.stats().points_matched == 0;
        if (i % 10 == 0) { // a query takes the same mesh
            struct Ignore : btCollisionWorld::ContactResultCallback {
                btScalar addSingleResult(btManifoldPoint&, const btCollisionObjectWrapper*, int, int,
                                         const btCollisionObjectWrapper*, int, int) override {
                    return 0;
                }
            } ignore;
            w.world.contactPairTest(&wheel, &rod, ignore);
        }
    }
    w.world.performDiscreteCollisionDetection();
    made += w.dispatcher.stats().shapes_made;
    EXPECT_LE(made, 2u);
    EXPECT_LE(changes, 2u);
}

TEST(BulletPose, AScaleThatDriftsMakesOneMeshAStep) {
    TestWorld w;
    btRigidBody& wheel = w.add_mesh(torus(), 0, at(0, 0, 0));
    wheel.setCollisionFlags(wheel.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    w.add_mesh(Shape::make(box_mesh(3, 0.2, 0.2)), 1, at(0, 0, 0));
    std::uint64_t made = 0, mended = 0;
    for (int i = 0; i < 2000; ++i) { // over the border of what is dropped, to 1.004 and back
        const double scale = 1 + 0.004 * (1 - std::fabs(i / 1000.0 - 1));
        wheel.setWorldTransform(with_basis(in_float(turned(0.01 * i) * diagonal(scale, scale, scale)), {0, 0, 0}));
        w.world.performDiscreteCollisionDetection();
        made += w.dispatcher.stats().shapes_made;
        mended += w.dispatcher.stats().made_rigid;
    }
    EXPECT_LE(made, 10u);
    EXPECT_GT(mended, 200u);
}

TEST(BulletPose, AStretchIsKeptWithinAStep) {
    const auto by = [](double scale, const bullet::Stretch& kept) {
        return bullet::place(with_basis(turned(1) * diagonal(scale, 1, 1), {0, 0, 0}), kept);
    };
    const bullet::Stretch kept = by(1.01, bullet::no_stretch).stretch;
    for (const double near : {1.0093, 1.0105}) EXPECT_EQ(by(near, kept).stretch, kept) << near;
    EXPECT_NEAR(by(1.0093, kept).unrounded[0], 1.0093, 1e-5); // planes
    for (const double far : {1.0085, 1.0115, 2.0, -1.01}) EXPECT_NE(by(far, kept).stretch, kept) << far;
    EXPECT_EQ(by(1, kept).stretch, bullet::no_stretch);
    // At the border of what is dropped, either way.
    const bullet::Stretch first = by(1.0011, bullet::no_stretch).stretch;
    EXPECT_NE(first, bullet::no_stretch);
    EXPECT_EQ(by(1.0009, first).stretch, first);
    EXPECT_FALSE(by(1.0009, first).drifted);
    EXPECT_TRUE(by(1.0009, bullet::no_stretch).drifted);
}

TEST(BulletPose, ThinScalesStayThin) {
    using bullet::Stretch;
    const Stretch thin = bullet::place(with_basis(turned(1) * diagonal(1, 1, 4e-4), {0, 0, 0})).stretch;
    EXPECT_NEAR(thin[0], 1, 1e-3);
    EXPECT_NEAR(thin[8], 4e-4, 4e-7);
    // Thin along none of the axes: each entry alone would be rounded to a flat one.
    const btMatrix3x3 turn = turned(1);
    const auto slanted = bullet::place(with_basis(turn * diagonal(1, 1, 4e-4) * turn.transpose(), {0, 0, 0}));
    const Stretch back = bullet::inverse(slanted.stretch), exact = bullet::inverse(slanted.unrounded);
    EXPECT_NEAR((back[0] + back[4] + back[8]) / (exact[0] + exact[4] + exact[8]), 1, 3e-3);

    for (const double z : {4e-4, 3.3333}) {
        TestWorld w;
        btRigidBody& plate = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, 0));
        plate.setWorldTransform(with_basis(diagonal(1, 1, z), btVector3(0, 0, btScalar(-z / 2))));
        w.world.updateSingleAabb(&plate);
        w.add_mesh(table(), 5, at(0.1, 0.2, 0.4 - 1e-4));
        w.world.performDiscreteCollisionDetection();
        EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
        EXPECT_GT(w.dispatcher.stats().contacts, 0u);

        // 100 m from its origin; no mesh is made of a plane, so nothing is rounded.
        TestWorld above;
        const btTransform pose = with_basis(diagonal(1, 1, z), {0, 0, 0});
        above.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(100)), 0, pose);
        above.add_mesh(table(), 5, at(0.1, 0.2, 100 * z + 0.39));
        above.world.performDiscreteCollisionDetection();
        ASSERT_GT(above.touching(), 0);
        const btPersistentManifold& touch = *above.dispatcher.getManifoldByIndexInternal(0);
        EXPECT_NEAR(double(touch.getContactPoint(0).getDistance()), -0.01, 1e-4) << z;
    }
}

/// The highest point of a table let fall on a scaled floor, after it came to rest.
double rest_on(TestWorld& w, btRigidBody& floor, const btMatrix3x3& basis, const btVector3& origin) {
    floor.setWorldTransform(with_basis(basis, origin));
    w.world.updateSingleAabb(&floor);
    const btRigidBody& body = w.add_mesh(table(), 5, at(0.1, 0.2, 1.5));
    w.steps(180);
    EXPECT_LT(double(body.getLinearVelocity().length()), 0.05);
    EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
    return double(body.getWorldTransform().getOrigin().z()) - 0.4;
}

TEST(BulletPose, BodiesRestOnAScaledFloor) {
    for (const double scale : {1.01, 2.0, 0.5}) {
        const btVector3 low(0, 0, btScalar(-0.5 * scale));
        const auto basis = diagonal(scale, scale, scale);
        {
            TestWorld w;
            btRigidBody& floor = w.add_mesh(Shape::make(box_mesh(12, 12, 1)), 0, at(0, 0, 0));
            EXPECT_NEAR(rest_on(w, floor, basis, low), 0, 0.02) << scale;
            EXPECT_EQ(w.dispatcher.stats().scaled, 1u);
        }
        {
            TestWorld w;
            btRigidBody& floor = w.add(std::make_unique<btBoxShape>(btVector3(6, 6, btScalar(0.5))), 0, at(0, 0, 0));
            EXPECT_NEAR(rest_on(w, floor, basis, low), 0, 0.02) << scale;
        }
        {
            TestWorld w; // the plane is at z = 0.5 in its frame
            btRigidBody& floor =
                w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0.5)), 0, at(0, 0, 0));
            EXPECT_NEAR(rest_on(w, floor, basis, low), 0, 0.02) << scale;
        }
        {
            const std::vector<btScalar> heights(13 * 13, btScalar(0.5)); // middle of its range: 0
            TestWorld w;
            btRigidBody& floor = w.add(
                std::make_unique<btHeightfieldTerrainShape>(13, 13, heights.data(), btScalar(0), btScalar(1), 2, false),
                0, at(0, 0, 0));
            EXPECT_NEAR(rest_on(w, floor, basis, btVector3(0, 0, 0)), 0, 0.02) << scale;
        }
        {
            TestWorld w;
            auto& mesh = w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(12, 12, 1))));
            auto compound = std::make_unique<btCompoundShape>();
            compound->addChildShape(btTransform(basis, low), &mesh);
            btRigidBody& floor = w.add(std::move(compound), 0, at(0, 0, 0));
            EXPECT_NEAR(rest_on(w, floor, btMatrix3x3::getIdentity(), btVector3(0, 0, 0)), 0, 0.02) << scale;
        }
    }
}

TEST(BulletPose, AScaledMeshHasTheContactsOfAScaledShape) {
    for (const btVector3& scale : {btVector3(2, 2, 2), btVector3(1, btScalar(0.5), 2), btVector3(-1, 1, 1)}) {
        TestWorld by_pose, by_shape;
        btRigidBody& scaled = by_pose.add_mesh(torus(), 0, at(0, 0, 0));
        scaled.setWorldTransform(
            with_basis(diagonal(double(scale.x()), double(scale.y()), double(scale.z())), {0, 0, 0}));
        by_pose.world.updateSingleAabb(&scaled);
        auto shape = std::make_unique<bullet::MeshShape>(torus());
        shape->setLocalScaling(scale);
        by_shape.add(std::move(shape), 0, at(0, 0, 0));
        for (TestWorld* w : {&by_pose, &by_shape}) {
            w->add_mesh(table(), 5, at(0.3, 0.2, 0.45));
            w->world.performDiscreteCollisionDetection();
        }
        const std::size_t found = by_pose.dispatcher.scene().contacts().size();
        EXPECT_EQ(found, by_shape.dispatcher.scene().contacts().size());
        EXPECT_GT(found, 0u);
        EXPECT_NEAR(by_pose.dispatcher.scene().stats().depth_max, by_shape.dispatcher.scene().stats().depth_max, 1e-5);
    }
}

TEST(BulletPose, WhatCannotBePlacedIsLeftOutAndNamed) {
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
        body.setWorldTransform(with_basis(basis, before.getOrigin()));
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
        bullet::place(with_basis(basis, {0, 0, 0}));
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(BulletPose, FaultsSayWhatIsWrong) {
    for (const btMatrix3x3& flat : {diagonal(0, 1, 1), diagonal(0, 0, 0), diagonal(-1, 0, 1), diagonal(1e-10, 1, 1)}) {
        EXPECT_NE(fault_of(flat).find("flat"), std::string::npos) << fault_of(flat);
        EXPECT_EQ(fault_of(flat).find("mirrored"), std::string::npos) << fault_of(flat); // it may be
        EXPECT_EQ(fault_of(flat).find("rotation"), std::string::npos) << fault_of(flat);
    }
    EXPECT_NE(fault_of(diagonal(1, double(nan), 1)).find("not a finite number"), std::string::npos);
    // Mirrored and small: the determinant is none of float's numbers.
    EXPECT_EQ(fault_of(diagonal(-1e-16, 1e-16, 1e-16)), "");
}

TEST(BulletPose, MeshesOfWhichNoneCanBeMadeAreLeftOutAndNamed) {
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

TEST(BulletPose, QueriesTakeThemToo) {
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
    high.setWorldTransform(with_basis(diagonal(1, 1, 4), {0, 0, btScalar(1.5)})); // down to -0.5
    EXPECT_GT(points(), 0);
    high.setWorldTransform(with_basis(diagonal(1, 1, 0), {0, 0, 0}));
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
    compound->addChildShape(with_basis(squeezed, btVector3(3, 0, btScalar(-0.5))),
                            &w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(2, 2, 1e5)))));
    btRigidBody& object = w.add(std::move(compound), 1, at(0, 0, 0));
    w.add_mesh(table(), 0, at(3, 0, 0.39));
    w.world.performDiscreteCollisionDetection();
    ASSERT_TRUE(w.dispatcher.stats().left_out.empty());
    ASSERT_GT(w.touching(), 0);
    object.setWorldTransform(with_basis(squeezed, btVector3(0, 0, 0))); // squeezed twice it is flat
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
    body.setWorldTransform(with_basis(diagonal(1, 1, 0), pose.getOrigin()));
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
TEST(BulletPose, NoSpeedEndsASimulation) {
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
TEST(BulletPose, ABodyThatBulletDisablesIsReported) {
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
TEST(BulletPose, ABodyInTheAirIsReportedInAnAttachedWorld) {
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
