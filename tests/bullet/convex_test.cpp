// SPDX-License-Identifier: Apache-2.0
// Bullet's convex shapes with meshes: at rest on each other, in compounds, when they change, when they are asked about.
#include "test_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace raycontact::test {
namespace {

struct Solid {
    const char* name;
    std::function<std::unique_ptr<btCollisionShape>()> make;
    double half; ///< from its origin down to its lowest point, upright, and up to its highest
    double flat; ///< half the width of its top; 0 if round or pointed
};

std::vector<Solid> solids() {
    const auto hull = [] {
        auto shape = std::make_unique<btConvexHullShape>();
        for (int k = 0; k < 8; ++k)
            shape->addPoint(
                btVector3(btScalar(k & 1 ? 0.6 : -0.6), btScalar(k & 2 ? 0.6 : -0.6), btScalar(k & 4 ? 0.4 : -0.4)));
        return shape;
    };
    const auto pill = [] { // a tablet: four balls
        const btScalar d = btScalar(0.5), radius = btScalar(0.3);
        const btVector3 centres[] = {btVector3(d, d, 0), btVector3(-d, d, 0), btVector3(-d, -d, 0),
                                     btVector3(d, -d, 0)};
        const btScalar radii[] = {radius, radius, radius, radius};
        return std::make_unique<btMultiSphereShape>(centres, radii, 4);
    };
    return {
        {"box", [] { return std::make_unique<btBoxShape>(btVector3(btScalar(0.6), btScalar(0.6), btScalar(0.4))); },
         0.4, 0.6},
        {"ball", [] { return std::make_unique<btSphereShape>(btScalar(0.4)); }, 0.4, 0},
        {"capsule", [] { return std::make_unique<btCapsuleShapeX>(btScalar(0.3), 1); }, 0.3, 0},
        {"cylinder",
         [] { return std::make_unique<btCylinderShapeZ>(btVector3(btScalar(0.6), btScalar(0.6), btScalar(0.4))); }, 0.4,
         0.42},
        {"cone", [] { return std::make_unique<btConeShapeZ>(btScalar(0.6), btScalar(0.8)); }, 0.4, 0},
        {"hull", hull, 0.4, 0.6},
        {"tablet", pill, 0.3, 0.5},
    };
}

void expect_still(TestWorld& w, const btRigidBody& body, double height, double tolerance, const char* name) {
    w.steps(180);
    for (int i = 0; i < 60; ++i) {
        w.steps(1);
        EXPECT_LT(double(body.getLinearVelocity().length()), 0.03) << name << ", step " << i;
    }
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), height, tolerance) << name;
    EXPECT_LT(
        std::hypot(double(body.getWorldTransform().getOrigin().x()), double(body.getWorldTransform().getOrigin().y())),
        0.05)
        << name;
}

TEST(Convex, EveryShapeRestsOnAMesh) {
    for (const Solid& solid : solids()) {
        TestWorld w;
        w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
        expect_still(w, w.add(solid.make(), 2, at(0, 0, solid.half + 0.1)), solid.half, 0.005, solid.name);
        EXPECT_EQ(w.dispatcher.stats().mesh_pairs + w.dispatcher.stats().round_pairs, 1u) << solid.name;
    }
}

TEST(Convex, MeshRestsOnEveryShape) {
    for (const Solid& solid : solids()) {
        if (solid.flat == 0) continue; // nothing rests on a ball or a tip
        TestWorld w;
        w.add(solid.make(), 0, at(0, 0, -solid.half));
        // Smaller and larger than what it stands on; the lower edge of the larger one is over the rim.
        for (const double size : {0.5, 3.0}) {
            btRigidBody& body = w.add_mesh(Shape::make(box_mesh(size, size, 0.4)), 5, at(0, 0, 0.25));
            expect_still(w, body, 0.2, 0.005, solid.name);
            w.remove(body);
        }
    }
}

/// Two parallel rails carry it, or a trough.
TEST(Convex, MeshRestsOnRoundShapes) {
    for (const bool capsules : {true, false}) {
        TestWorld w;
        for (const double y : {-0.5, 0.5}) {
            std::unique_ptr<btCollisionShape> rail;
            if (capsules)
                rail = std::make_unique<btCapsuleShapeX>(btScalar(0.2), 3);
            else
                rail = std::make_unique<btCylinderShapeX>(btVector3(2, btScalar(0.2), btScalar(0.2)));
            w.add(std::move(rail), 0, at(0, y, -0.2));
        }
        expect_still(w, w.add_mesh(table(), 5, at(0, 0, 0.45)), 0.4, 0.005, capsules ? "capsules" : "cylinders");
    }
    TestWorld w; // four balls
    for (const double x : {-0.4, 0.4})
        for (const double y : {-0.4, 0.4}) w.add(std::make_unique<btSphereShape>(btScalar(0.3)), 0, at(x, y, -0.3));
    expect_still(w, w.add_mesh(Shape::make(box_mesh(2, 2, 0.4)), 5, at(0, 0, 0.25)), 0.2, 0.005, "balls");
}

/// One that was dropped too fast comes up again.
TEST(Convex, BallDeepInAMeshComesOut) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    const btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.1)), 1, at(0, 0, -0.3));
    w.steps(300);
    EXPECT_NEAR(double(ball.getWorldTransform().getOrigin().z()), 0.1, 0.01);
}

TEST(Convex, CylinderRollsOnAMesh) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(30, 6, 1)), 0, at(12, 0, -0.5));
    btRigidBody& body = w.add(std::make_unique<btCylinderShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5))),
                              5, at(0, 0, 0.5)); // its axis is y
    body.setLinearVelocity(btVector3(3, 0, 0));
    body.setAngularVelocity(btVector3(0, 6, 0));
    w.steps(180);
    const btVector3 at_end = body.getWorldTransform().getOrigin();
    EXPECT_GT(double(at_end.x()), 5);
    EXPECT_LT(std::fabs(double(at_end.y())), 0.01 * double(at_end.x()));
    EXPECT_NEAR(double(at_end.z()), 0.5, 0.01);
}

/// Meshes and every convex shape on a heap, on a floor of Bullet's: nobody falls through, and nobody flies off.
TEST(Convex, HeapOfEverythingStaysInItsPen) {
    TestWorld w;
    w.add(std::make_unique<btBoxShape>(btVector3(6, 6, btScalar(0.5))), 0, at(0, 0, -0.5));
    for (const double side : {-1.0, 1.0}) { // walls of meshes
        w.add_mesh(Shape::make(box_mesh(0.5, 4.5, 20)), 0, at(2.25 * side, 0, 10));
        w.add_mesh(Shape::make(box_mesh(4.5, 0.5, 20)), 0, at(0, 2.25 * side, 10));
    }
    const std::size_t first = w.bodies.size();
    int place = 0; // four in a layer, apart
    const auto next = [&] {
        const double x = place % 2 ? 0.9 : -0.9, y = place / 2 % 2 ? 0.9 : -0.9;
        const int layer = place++ / 4;
        return at(x, y, 0.9 + 1.4 * layer);
    };
    for (int layer = 0; layer < 3; ++layer)
        for (const Solid& solid : solids()) {
            w.add(solid.make(), 2, next());
            w.add_mesh((place / 2) % 2 ? table() : torus(), 2, next());
        }
    w.steps(1200); // what leans on a wall may fall late
    double fastest = 0;
    for (std::size_t i = first; i < w.bodies.size(); ++i) {
        const btRigidBody& body = *w.bodies[i];
        const btVector3 o = body.getWorldTransform().getOrigin();
        EXPECT_GT(double(o.z()), 0.02) << i;
        EXPECT_LT(std::fabs(double(o.x())), 6) << i;
        fastest = std::max(fastest, double(body.getLinearVelocity().length()));
    }
    EXPECT_LT(fastest, 1.5);
    EXPECT_GT(w.dispatcher.stats().round_pairs, 5u);
    EXPECT_GT(w.dispatcher.stats().mesh_pairs, 20u);
}

TEST(Convex, LeftToBulletIfAsked) {
    TestWorld w({}, {}, bullet::ConvexShapes::bullet);
    w.add(std::make_unique<btBoxShape>(btVector3(3, 3, btScalar(0.5))), 0, at(0, 0, -0.5));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.45));
    w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, at(0, 0, 1.2));
    w.steps(120);
    EXPECT_EQ(w.dispatcher.stats().pairs, 0u);
    EXPECT_EQ(w.dispatcher.stats().other_pairs, 2u);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.06); // its margins lie between
}

TEST(Convex, OtherConvexShapesAreBullets) {
    TestWorld w;
    auto flat = std::make_unique<btConvexHullShape>();
    for (const double x : {-2.0, 2.0})
        for (const double y : {-2.0, 2.0}) flat->addPoint(btVector3(btScalar(x), btScalar(y), 0));
    w.add(std::move(flat), 0, at(0, 0, 0));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.5));
    w.steps(120);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 0u);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.06);
}

TEST(Convex, CompoundsOfBoth) {
    // A dumb-bell of two balls and a box between them, on a floor of a mesh and a box beside it.
    TestWorld w;
    auto floor = std::make_unique<btCompoundShape>();
    floor->addChildShape(at(-1, 0, -0.5), &w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(2, 4, 1)))));
    floor->addChildShape(at(1, 0, -0.5), &w.keep(std::make_unique<btBoxShape>(btVector3(1, 2, btScalar(0.5)))));
    w.add(std::move(floor), 0, at(0, 0, 0));
    auto bell = std::make_unique<btCompoundShape>();
    auto& ball = w.keep(std::make_unique<btSphereShape>(btScalar(0.3)));
    bell->addChildShape(at(-0.6, 0, 0), &ball);
    bell->addChildShape(at(0.6, 0, 0), &ball);
    const btVector3 half(btScalar(0.6), btScalar(0.1), btScalar(0.3));
    bell->addChildShape(at(0, 0, 0), &w.keep(std::make_unique<btBoxShape>(half)));
    const btRigidBody& body = w.add(std::move(bell), 3, at(0, 0, 0.4));
    w.steps(180);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.3, 0.01);
    EXPECT_GT(double(body.getWorldTransform().getBasis()[2].z()), 0.999);
    EXPECT_EQ(w.dispatcher.stats().round_pairs, 2u); // both balls with the mesh; the box carries them by Bullet
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 1u);
    // And a mesh on the dumb-bell: three pairs more.
    w.add_mesh(Shape::make(box_mesh(1, 1, 0.2)), 1, at(0, 0, 0.75));
    w.steps(60);
    EXPECT_EQ(w.dispatcher.stats().round_pairs, 4u);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 2u);
}

TEST(Convex, MarginsAreTheShapes) {
    for (const double margin : {0.0, 0.04, 0.1}) {
        TestWorld w;
        auto box = std::make_unique<btBoxShape>(btVector3(3, 3, btScalar(0.5)));
        box->setMargin(btScalar(margin));
        w.add(std::move(box), 0, at(0, 0, -0.5));
        expect_still(w, w.add_mesh(table(), 5, at(0, 0, 0.45)), 0.4, 0.005, "box");
        auto hull = std::make_unique<btConvexHullShape>();
        for (int k = 0; k < 8; ++k)
            hull->addPoint(
                btVector3(btScalar(k & 1 ? 0.6 : -0.6), btScalar(k & 2 ? 0.6 : -0.6), btScalar(k & 4 ? 0.2 : -0.2)));
        hull->setMargin(btScalar(margin));
        expect_still(w, w.add(std::move(hull), 1, at(0, 0, 1.05)), 1, 0.01, "hull"); // on the table
    }
}

TEST(Convex, ChangedDimensionsAreSeen) {
    TestWorld w;
    auto shape = std::make_unique<btBoxShape>(btVector3(3, 3, btScalar(0.5)));
    btBoxShape& box = *shape;
    btRigidBody& ground = w.add(std::move(shape), 0, at(0, 0, -0.5));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.41));
    w.steps(60);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.01);
    box.setLocalScaling(btVector3(1, 1, btScalar(1.1)));
    w.world.updateSingleAabb(&ground);
    w.steps(120);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.45, 0.01);
    box.setImplicitShapeDimensions(btVector3(3, 3, btScalar(0.5)) - btVector3(1, 1, 1) * box.getMargin());
    w.world.updateSingleAabb(&ground);
    w.steps(120);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.01);
    // A ball that grows carries it up.
    auto made = std::make_unique<btSphereShape>(btScalar(0.2));
    btSphereShape& ball = *made;
    btRigidBody& lifted = w.add(std::move(made), 1, at(0, 0, 1.02));
    w.steps(120);
    EXPECT_NEAR(double(lifted.getWorldTransform().getOrigin().z()), 1, 0.01);
    ball.setUnscaledRadius(btScalar(0.25));
    w.world.updateSingleAabb(&lifted);
    w.steps(120);
    EXPECT_NEAR(double(lifted.getWorldTransform().getOrigin().z()), 1.05, 0.01);
}

TEST(Convex, SpeculativeContactsStopAMeshAtABox) {
    // A mesh at 60 m/s on a box of 5 cm: it moves by a metre in a step.
    for (const bool speculative : {false, true}) {
        Settings settings;
        settings.speculative = speculative ? Speculative::on : Speculative::off;
        TestWorld w(settings);
        w.world.setGravity(btVector3(0, 0, 0));
        w.add(std::make_unique<btBoxShape>(btVector3(3, 3, btScalar(0.025))), 0, at(0, 0, 0));
        btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 1.7));
        body.setLinearVelocity(btVector3(0, 0, -60));
        w.steps(20);
        EXPECT_EQ(double(body.getWorldTransform().getOrigin().z()) > 0, speculative);
    }
}

struct Found : btCollisionWorld::ContactResultCallback {
    int count = 0;
    btScalar deepest = 1, upward = 0;
    btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        ++count;
        deepest = btMin(deepest, p.getDistance());
        upward = p.m_normalWorldOnB.z();
        return 0;
    }
};

TEST(Convex, ContactTestsOfEveryShape) {
    for (const Solid& solid : solids()) {
        TestWorld w;
        btRigidBody& ground = w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
        btRigidBody& body = w.add(solid.make(), 2, at(0, 0, solid.half - 0.01));
        for (const bool swapped : {false, true}) {
            Found found;
            w.world.contactPairTest(swapped ? &ground : &body, swapped ? &body : &ground, found);
            EXPECT_GT(found.count, 0) << solid.name;
            EXPECT_NEAR(double(found.deepest), -0.01, 2e-3) << solid.name;
            EXPECT_NEAR(double(found.upward), swapped ? -1 : 1, 1e-3) << solid.name;
        }
        Found all;
        w.world.contactTest(&body, all);
        EXPECT_GT(all.count, 0) << solid.name;
        body.setWorldTransform(at(0, 0, solid.half + 0.05));
        w.world.updateSingleAabb(&body);
        Found none;
        w.world.contactPairTest(&body, &ground, none);
        EXPECT_EQ(none.count, 0) << solid.name;
        // What is apart by less than was asked for.
        Found near;
        near.m_closestDistanceThreshold = btScalar(0.2);
        w.world.contactPairTest(&body, &ground, near);
        EXPECT_GT(near.count, 0) << solid.name;
        EXPECT_NEAR(double(near.deepest), 0.05, 0.05) << solid.name; // Bullet's has margins
    }
}

TEST(Convex, ContactTestOfCompounds) {
    TestWorld w;
    auto floor = std::make_unique<btCompoundShape>();
    floor->addChildShape(at(-1, 0, -0.5), &w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(2, 4, 1)))));
    floor->addChildShape(at(1, 0, -0.5), &w.keep(std::make_unique<btBoxShape>(btVector3(1, 2, btScalar(0.5)))));
    btRigidBody& ground = w.add(std::move(floor), 0, at(0, 0, 0));
    btRigidBody& mesh = w.add_mesh(table(), 1, at(0, 0, 0.39));
    Found found;
    w.world.contactPairTest(&mesh, &ground, found);
    EXPECT_EQ(found.count, 16); // eight vertices over each half
    EXPECT_NEAR(double(found.deepest), -0.01, 1e-4);
    btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, at(1, 1.5, 0.19));
    Found other; // with the box: Bullet's own algorithm, asked by ours
    w.world.contactPairTest(&ground, &ball, other);
    EXPECT_EQ(other.count, 1);
    EXPECT_NEAR(double(other.deepest), -0.01, 1e-4);
}

} // namespace
} // namespace raycontact::test
