// SPDX-License-Identifier: Apache-2.0
// Transforms that Bullet takes although they are not rigid.
#include "test_world.h"

#include <placement.h>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace raycontact::test {
namespace {

constexpr btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();

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
    EXPECT_FALSE(bullet::place(btTransform(turned(1), origin)).drifted);
    for (const double off : {1e-4, 5e-4}) {
        const auto placed = bullet::place(btTransform(turned(1) * diagonal(1, 1 + off, 1), origin));
        EXPECT_TRUE(placed.drifted);
        EXPECT_EQ(placed.stretch, bullet::no_stretch);
        EXPECT_EQ(placed.pose.getOrigin(), origin);
        EXPECT_FALSE(bullet::place(placed.pose).drifted);
    }
    const btMatrix3x3 shear(1, btScalar(0.5), 0, 0, 1, 0, 0, 0, 1);
    for (const btMatrix3x3& basis : {diagonal(1.01, 1.01, 1.01), diagonal(2.5, 2.5, 2.5), diagonal(0.01, 0.01, 0.01),
                                     diagonal(1, 2, 30), diagonal(-1, 1, 1), diagonal(-3, -3, -3), shear}) {
        const btMatrix3x3 given = turned(1) * basis;
        const auto placed = bullet::place(btTransform(given, origin));
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
    EXPECT_THROW(bullet::place(btTransform(unturned, btVector3(0, nan, 0))), InputError);
    EXPECT_THROW(bullet::place(btTransform(diagonal(1, double(nan), 1), origin)), InputError);
    EXPECT_THROW(bullet::place(btTransform(diagonal(0, 1, 1), origin)), InputError);
    EXPECT_THROW(bullet::place(btTransform(diagonal(0, 0, 0), origin)), InputError);
    EXPECT_THROW(bullet::place(btTransform(diagonal(1, 1, double(INFINITY)), origin)), InputError);
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
        wheel.setWorldTransform(btTransform(in_float(turned(0.01 * i) * diagonal(scale, scale, scale)), {0, 0, 0}));
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
        wheel.setWorldTransform(btTransform(in_float(turned(0.01 * i) * diagonal(scale, scale, scale)), {0, 0, 0}));
        w.world.performDiscreteCollisionDetection();
        made += w.dispatcher.stats().shapes_made;
        mended += w.dispatcher.stats().made_rigid;
    }
    EXPECT_LE(made, 10u);
    EXPECT_GT(mended, 200u);
}

TEST(BulletPose, AStretchIsKeptWithinAStep) {
    const auto by = [](double scale, const bullet::Stretch& kept) {
        return bullet::place(btTransform(turned(1) * diagonal(scale, 1, 1), {0, 0, 0}), kept);
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
    const Stretch thin = bullet::place(btTransform(turned(1) * diagonal(1, 1, 4e-4), {0, 0, 0})).stretch;
    EXPECT_NEAR(thin[0], 1, 1e-3);
    EXPECT_NEAR(thin[8], 4e-4, 4e-7);
    // Thin along none of the axes: each entry alone would be rounded to a flat one.
    const btMatrix3x3 turn = turned(1);
    const auto slanted = bullet::place(btTransform(turn * diagonal(1, 1, 4e-4) * turn.transpose(), {0, 0, 0}));
    const Stretch back = bullet::inverse(slanted.stretch), exact = bullet::inverse(slanted.unrounded);
    EXPECT_NEAR((back[0] + back[4] + back[8]) / (exact[0] + exact[4] + exact[8]), 1, 3e-3);

    for (const double z : {4e-4, 3.3333}) {
        TestWorld w;
        btRigidBody& plate = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, 0));
        plate.setWorldTransform(btTransform(diagonal(1, 1, z), btVector3(0, 0, btScalar(-z / 2))));
        w.world.updateSingleAabb(&plate);
        w.add_mesh(table(), 5, at(0.1, 0.2, 0.4 - 1e-4));
        w.world.performDiscreteCollisionDetection();
        EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
        EXPECT_GT(w.dispatcher.stats().contacts, 0u);

        // 100 m from its origin; no mesh is made of a plane, so nothing is rounded.
        TestWorld above;
        const btTransform pose = btTransform(diagonal(1, 1, z), {0, 0, 0});
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
    floor.setWorldTransform(btTransform(basis, origin));
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
            btTransform(diagonal(double(scale.x()), double(scale.y()), double(scale.z())), {0, 0, 0}));
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

} // namespace
} // namespace raycontact::test
