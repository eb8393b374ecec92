// SPDX-License-Identifier: Apache-2.0
// Rays, sweeps and contact tests of btCollisionWorld against our shape.
#include "test_world.h"

#include <query.h>
#include <raycontact/error.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace raycontact::test {
namespace {

struct Found : btCollisionWorld::ContactResultCallback {
    int count = 0;
    btScalar deepest = 0;
    btVector3 normal{0, 0, 0};
    const btCollisionObject* first = nullptr;
    btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper* a, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        ++count;
        if (p.getDistance() < deepest) {
            deepest = p.getDistance();
            normal = p.m_normalWorldOnB;
            first = a->getCollisionObject();
        }
        return 0;
    }
};

TEST(Query, RayHitsTheMesh) {
    TestWorld w;
    const btRigidBody& body = w.add_mesh(table(), 0, at(0, 0, 0));
    const btVector3 from(btScalar(0.05), btScalar(0.02), 3), to(btScalar(0.05), btScalar(0.02), -3);
    btCollisionWorld::ClosestRayResultCallback hit(from, to);
    w.world.rayTest(from, to, hit);
    ASSERT_TRUE(hit.hasHit());
    EXPECT_EQ(hit.m_collisionObject, &body);
    EXPECT_NEAR(double(hit.m_hitPointWorld.z()), 0.4, 1e-5);
    EXPECT_NEAR(double(hit.m_hitNormalWorld.z()), 1, 1e-5);
    // Between the legs, under the top: nothing.
    const btVector3 side0(-3, 0, btScalar(-0.2)), side1(3, 0, btScalar(-0.2));
    btCollisionWorld::ClosestRayResultCallback miss(side0, side1);
    w.world.rayTest(side0, side1, miss);
    EXPECT_FALSE(miss.hasHit());
}

TEST(Query, SweepStopsAtTheMesh) {
    TestWorld w;
    w.add_mesh(table(), 0, at(0, 0, 0));
    const btSphereShape ball(btScalar(0.1));
    const btVector3 from(0, 0, 3), to(0, 0, -3);
    btCollisionWorld::ClosestConvexResultCallback hit(from, to);
    w.world.convexSweepTest(&ball, at(0, 0, 3), at(0, 0, -3), hit);
    ASSERT_TRUE(hit.hasHit());
    EXPECT_NEAR(3 - 6 * double(hit.m_closestHitFraction), 0.5, 0.01);
}

TEST(Query, ContactPairTestOfTwoMeshes) {
    TestWorld w;
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& high = w.add_mesh(table(), 0, at(0, 0, 0.39));
    Found found, other;
    w.world.contactPairTest(&high, &low, found);
    EXPECT_EQ(found.count, 16); // four feet of four vertices
    EXPECT_NEAR(double(found.deepest), -0.01, 1e-5);
    EXPECT_NEAR(std::fabs(double(found.normal.z())), 1, 1e-5);
    EXPECT_EQ(found.normal.z() > 0, found.first == &high); // from B to A
    w.world.contactTest(&high, other);
    EXPECT_EQ(other.count, 16);
}

// Two bodies a call, for one step: each takes the slots of those before.
TEST(Query, AHundredThousandCallsNeedFourSlots) {
    TestWorld w;
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& high = w.add_mesh(Shape::make(box_mesh(1, 1, 1)), 0, at(0, 0, 0.49));
    Settings settings;
    settings.execution.threads = 1;
    Scene scene(settings);
    bullet::Objects objects(scene, bullet::ConvexShapes::ours);
    bullet::Queries queries(settings, objects, bullet::ConvexShapes::ours, w.dispatcher);
    const btCollisionObjectWrapper a(nullptr, low.getCollisionShape(), &low, low.getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper b(nullptr, high.getCollisionShape(), &high, high.getWorldTransform(), -1, -1);
    btPersistentManifold* manifold = w.dispatcher.getNewManifold(&low, &high);
    for (int i = 0; i < 100000; ++i) {
        btManifoldResult result(&a, &b);
        result.setPersistentManifold(manifold);
        queries.run(a, b, w.world.getDispatchInfo(), result);
        ASSERT_EQ(queries.scene().contacts().size(), 4u) << i;
        ASSERT_LT(queries.scene().contacts().front().body_b.slot, 4u) << i;
    }
    EXPECT_EQ(manifold->getNumContacts(), 4);
    EXPECT_EQ(queries.scene().body_count(), 0u);
    w.dispatcher.releaseManifold(manifold);
}

/// Notes depths, and calls `then` for each.
struct Noted : btCollisionWorld::ContactResultCallback {
    std::vector<btScalar> depths;
    std::function<void()> then = [] {};
    btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        depths.push_back(p.getDistance());
        then();
        return 0;
    }
};

TEST(Query, ACallbackMayAskAboutAnotherPair) {
    TestWorld w;
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& high = w.add_mesh(table(), 0, at(0, 0, 0.39));
    btRigidBody& ring = w.add_mesh(torus(), 0, at(3, 0, 0));
    btRigidBody& box = w.add_mesh(Shape::make(box_mesh(1, 1, 1)), 0, at(3.4, 0.1, 0.2));
    Noted alone, other, nested;
    w.world.contactPairTest(&high, &low, alone);
    w.world.contactPairTest(&ring, &box, other);
    ASSERT_EQ(alone.depths.size(), 16u);
    ASSERT_FALSE(other.depths.empty());
    nested.then = [&] {
        Noted inner;
        w.world.contactPairTest(&ring, &box, inner);
        EXPECT_EQ(inner.depths, other.depths);
    };
    w.world.contactPairTest(&high, &low, nested);
    EXPECT_EQ(nested.depths, alone.depths);
}

TEST(Query, ACallbackMayThrow) {
    TestWorld w;
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& high = w.add_mesh(table(), 0, at(0, 0, 0.39));
    // One of these is Bullet's pair of leaves.
    auto both = std::make_unique<btCompoundShape>();
    both->addChildShape(at(0, 0, 0.3), &w.keep(std::make_unique<btBoxShape>(btVector3(1, 1, 1))));
    both->addChildShape(at(0, 0, 9), &w.keep(std::make_unique<bullet::MeshShape>(table())));
    btRigidBody& compound = w.add(std::move(both), 0, at(0, 0, 0));
    btRigidBody& ball = w.add(std::make_unique<btCompoundShape>(), 0, at(0, 0, 0));
    static_cast<btCompoundShape*>(ball.getCollisionShape())
        ->addChildShape(at(0, 0, 1.3), &w.keep(std::make_unique<btSphereShape>(btScalar(0.4))));
    static_cast<btCompoundShape*>(ball.getCollisionShape())
        ->addChildShape(at(9, 0, 0), &w.keep(std::make_unique<bullet::MeshShape>(table())));
    const int manifolds = w.dispatcher.getNumManifolds();
    for (const auto& [a, b] : {std::pair(&high, &low), std::pair(&compound, &ball)}) {
        Noted noted;
        noted.then = [] { throw std::runtime_error("enough"); };
        EXPECT_THROW(w.world.contactPairTest(a, b, noted), std::runtime_error);
        EXPECT_EQ(w.dispatcher.getNumManifolds(), manifolds);
        noted.then = [] {};
        noted.depths.clear();
        w.world.contactPairTest(a, b, noted);
        EXPECT_FALSE(noted.depths.empty());
    }
}

TEST(Query, WhatThrowsLeavesNoBody) {
    struct Throwing : btManifoldResult {
        using btManifoldResult::btManifoldResult;
        void addContactPoint(const btVector3&, const btVector3&, btScalar) override {
            throw std::runtime_error("enough");
        }
    };
    TestWorld w;
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& high = w.add_mesh(Shape::make(box_mesh(1, 1, 1)), 0, at(0, 0, 0.49));
    Scene scene{Settings{}};
    bullet::Objects objects(scene, bullet::ConvexShapes::ours);
    bullet::Queries queries({}, objects, bullet::ConvexShapes::ours, w.dispatcher);
    const btCollisionObjectWrapper a(nullptr, low.getCollisionShape(), &low, low.getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper b(nullptr, high.getCollisionShape(), &high, high.getWorldTransform(), -1, -1);
    Throwing result(&a, &b);
    EXPECT_THROW(queries.run(a, b, w.world.getDispatchInfo(), result), std::runtime_error);
    EXPECT_EQ(queries.scene().body_count(), 0u);
}

/// Counts how often its triangles are read.
struct CountedMesh : btTriangleMesh {
    mutable int reads = 0;
    explicit CountedMesh(const Shape& shape) {
        const auto corner = [&](std::uint32_t v) {
            const Vec3& p = shape.vertices()[v];
            return btVector3(btScalar(p.x), btScalar(p.y), btScalar(p.z));
        };
        for (const auto& t : shape.triangles()) addTriangle(corner(t[0]), corner(t[1]), corner(t[2]));
    }
    void getLockedReadOnlyVertexIndexBase(const unsigned char** vertices, int& vertex_count, PHY_ScalarType& type,
                                          int& stride, const unsigned char** indices, int& index_stride, int& triangles,
                                          PHY_ScalarType& index_type, int part) const override {
        ++reads;
        btTriangleMesh::getLockedReadOnlyVertexIndexBase(vertices, vertex_count, type, stride, indices, index_stride,
                                                         triangles, index_type, part);
    }
};

// In the hole of a ring, so that no triangle is looked up for a name.
TEST(Query, AMeshOfBulletsIsReadOnce) {
    CountedMesh mesh(*torus());
    TestWorld w;
    btRigidBody& ring = w.add(std::make_unique<btBvhTriangleMeshShape>(&mesh, true), 0, at(0, 0, 0));
    btRigidBody& box = w.add_mesh(Shape::make(box_mesh(0.1, 0.1, 0.1)), 0, at(0, 0, 0));
    Found found;
    w.world.contactPairTest(&ring, &box, found);
    const int once = mesh.reads;
    for (int i = 0; i < 10; ++i) w.world.contactPairTest(&ring, &box, found);
    EXPECT_EQ(mesh.reads, once);
    EXPECT_EQ(found.count, 0);
    w.dispatcher.refresh(ring);
    w.world.contactPairTest(&ring, &box, found);
    EXPECT_GT(mesh.reads, once);
    // Scaled it is another mesh.
    const int again = mesh.reads;
    ring.getCollisionShape()->setLocalScaling(btVector3(2, 2, 2));
    w.world.contactPairTest(&ring, &box, found);
    EXPECT_GT(mesh.reads, again);
}

TEST(Query, WithoutADispatchOldShapesAreForgotten) {
    TestWorld w;
    btRigidBody& low = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    Settings settings;
    settings.execution.threads = 1;
    Scene scene(settings);
    bullet::Objects objects(scene, bullet::ConvexShapes::ours);
    bullet::ShapeCache& shapes = objects.shapes();
    bullet::Queries queries(settings, objects, bullet::ConvexShapes::ours, w.dispatcher);
    const btCollisionObjectWrapper a(nullptr, low.getCollisionShape(), &low, low.getWorldTransform(), -1, -1);
    std::vector<std::weak_ptr<const Shape>> made;
    btBoxShape first(btVector3(1, 1, 1));
    btCollisionObject object;
    object.setCollisionShape(&first);
    object.setWorldTransform(at(0, 0, 0.3));
    btPersistentManifold* manifold = w.dispatcher.getNewManifold(&low, &object);
    for (int i = 0; i < 2000; ++i) {
        const btBoxShape box(btVector3(1, 1, 1) * btScalar(0.5 + 1e-4 * i));
        const btCollisionObjectWrapper b(nullptr, &box, &object, object.getWorldTransform(), -1, -1);
        btManifoldResult result(&a, &b);
        result.setPersistentManifold(manifold);
        queries.run(a, b, w.world.getDispatchInfo(), result);
        made.push_back(shapes.get(box).shape);
    }
    EXPECT_LT(std::count_if(made.begin(), made.end(), [](const auto& shape) { return !shape.expired(); }), 1000);
    w.dispatcher.releaseManifold(manifold);
}

TEST(Query, ContactPairTestWithPlaneBothWays) {
    TestWorld w;
    btRigidBody& plane = w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0, at(0, 0, 0));
    btRigidBody& mesh = w.add_mesh(table(), 0, at(0, 0, 0.38));
    for (const bool swapped : {false, true}) {
        Found found;
        w.world.contactPairTest(swapped ? &plane : &mesh, swapped ? &mesh : &plane, found);
        EXPECT_EQ(found.count, 16);
        EXPECT_NEAR(double(found.deepest), -0.02, 1e-5);
        EXPECT_EQ(found.normal.z() > 0, found.first == &mesh);
    }
}

TEST(Query, ContactTestWithSphere) {
    TestWorld w;
    btRigidBody& mesh = w.add_mesh(table(), 0, at(0, 0, 0));
    btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 0, at(0, 0, 0.59));
    Found found;
    w.world.contactPairTest(&mesh, &ball, found);
    EXPECT_GT(found.count, 0);
    EXPECT_NEAR(double(found.deepest), -0.01, 2e-3);
}

} // namespace
} // namespace raycontact::test
