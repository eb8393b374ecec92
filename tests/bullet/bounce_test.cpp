// SPDX-License-Identifier: Apache-2.0
// How high what falls with restitution comes again: e^2 of its height, wherever the steps meet the surface.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace raycontact::test {
namespace {

/// All of them 0.1 m above the ground where they rest.
std::unique_ptr<btCollisionShape> faller(int kind) {
    const auto half = btScalar(0.1);
    if (kind == 0) return std::make_unique<btSphereShape>(half);
    if (kind == 1) return std::make_unique<btCapsuleShapeX>(half, btScalar(0.2));
    if (kind == 2) return std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(0.3, 0.24, 0.2)));
    return std::make_unique<btBoxShape>(btVector3(btScalar(0.15), btScalar(0.12), half));
}

struct Drop {
    int kind, hertz;
    double restitution, height;
};

/// Metres above where it rests, the most between the first two times that it touches.
double rebound(const Drop& drop) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5)).setRestitution(1);
    btRigidBody& body = w.add(faller(drop.kind), 1, at(0.13, 0.21, 0.1 + drop.height));
    body.setRestitution(btScalar(drop.restitution));
    bullet::recommend(w.world);
    double top = 0;
    bool rises = false;
    for (int i = 0; i < 4 * drop.hertz; ++i) {
        w.world.stepSimulation(btScalar(1.0 / drop.hertz), 0);
        const btScalar speed = body.getLinearVelocity().z();
        if (rises && speed <= 0) break;
        rises = rises || speed > btScalar(1e-3);
        if (rises) top = std::max(top, double(body.getWorldTransform().getOrigin().z()) - 0.1);
    }
    return top;
}

// Also where it would rise less than it falls in a step, to where no step has it.
TEST(Bounce, RisesToThePartOfItsHeight) {
    for (int kind = 0; kind < 4; ++kind)
        for (const int hertz : {60, 240})
            for (const double restitution : {0.2, 0.5, 0.9, 1.0})
                for (const double height : {0.1, 0.3, 0.317, 1.0, 1.034, 3.0}) {
                    const double right = restitution * restitution * height;
                    EXPECT_NEAR(rebound({kind, hertz, restitution, height}), right, 0.05 * right + 1e-4)
                        << kind << ", " << hertz << " Hz, restitution " << restitution << ", height " << height;
                }
}

// Of two that meet, that which is hit goes on with what restitution says.
TEST(Bounce, OneBallHitsAnother) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
        TestWorld w;
        w.world.setGravity(btVector3(0, 0, 0));
        btRigidBody& still = w.add_mesh(Shape::make(box_mesh(0.4, 0.4, 0.4)), 2, at(0, 0, 0));
        btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.1)), 1, at(-1, 0, 0));
        still.setRestitution(1), ball.setRestitution(btScalar(restitution));
        still.setFriction(0), ball.setFriction(0);
        ball.setLinearVelocity(btVector3(3, 0, 0));
        w.steps(60);
        EXPECT_NEAR(double(still.getLinearVelocity().x()), 1 + restitution, 0.01) << restitution;
        EXPECT_NEAR(double(ball.getLinearVelocity().x()), 1 - 2 * restitution, 0.02) << restitution;
    }
}

} // namespace
} // namespace raycontact::test
