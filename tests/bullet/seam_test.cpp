// SPDX-License-Identifier: Apache-2.0
// Balls and capsules on flat ground that is cut in pieces: they feel nothing of it, however it is cut.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>
#include <scenes/random.h>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace raycontact::test {
namespace {

struct Rectangle {
    double low[2], high[2];
};

/// Cuts a rectangle across its longer side, and the pieces again: T-junctions of every ratio of sizes.
void cut(const Rectangle& r, int times, scenes::Random& random, std::vector<Rectangle>& out) {
    if (times == 0) {
        out.push_back(r);
        return;
    }
    const int k = r.high[0] - r.low[0] > r.high[1] - r.low[1] ? 0 : 1;
    const double at = r.low[k] + (0.5 + 0.47 * random.symmetric()) * (r.high[k] - r.low[k]);
    Rectangle one = r, two = r;
    one.high[k] = two.low[k] = at;
    cut(one, times - 1, random, out);
    cut(two, times - 1, random, out);
}

std::vector<Rectangle> floor_pieces(scenes::Random& random, int times) {
    std::vector<Rectangle> pieces;
    cut({{-6, -6}, {6, 6}}, times, random, pieces);
    return pieces;
}

/// Two triangles for each; no piece shares a vertex with another but by chance.
Mesh sheet_of(const std::vector<Rectangle>& pieces) {
    Mesh mesh;
    mesh.name = "sheet";
    for (const Rectangle& r : pieces) {
        const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const int k : {0, 1, 2, 3})
            mesh.vertices.push_back({k == 0 || k == 3 ? r.low[0] : r.high[0], k < 2 ? r.low[1] : r.high[1], 0});
        mesh.triangles.push_back({n, n + 1, n + 2});
        mesh.triangles.push_back({n, n + 2, n + 3});
    }
    return mesh;
}

enum class Ground { junctions, bodies, strips, field };

/// All of their tops are the plane z = 0 of `frame`. unevenness: of bodies, metres.
void add_ground(TestWorld& w, Ground ground, const btTransform& frame, scenes::Random& random, double unevenness) {
    switch (ground) {
    case Ground::junctions:
        w.add_mesh(Shape::make(sheet_of(floor_pieces(random, 5))), 0, frame);
        break;
    case Ground::bodies:
        for (const Rectangle& r : floor_pieces(random, 4)) {
            const double height = 1 + 0.4 * random.symmetric(), x = (r.low[0] + r.high[0]) / 2,
                         y = (r.low[1] + r.high[1]) / 2;
            w.add_mesh(Shape::make(box_mesh(r.high[0] - r.low[0], r.high[1] - r.low[1], height)), 0,
                       frame * at(x, y, -height / 2 + unevenness * random.symmetric()));
        }
        break;
    case Ground::strips: { // 12 m long and 0.06 m wide
        std::vector<Rectangle> pieces;
        for (int i = 0; i < 200; ++i) pieces.push_back({{-6, -6 + 0.06 * i}, {6, -6 + 0.06 * (i + 1)}});
        w.add_mesh(Shape::make(sheet_of(pieces)), 0, frame);
        break;
    }
    case Ground::field: {
        static const std::vector<float> heights(49 * 49, 0);
        auto field = std::make_unique<btHeightfieldTerrainShape>(49, 49, heights.data(), btScalar(1), btScalar(-1),
                                                                 btScalar(1), 2, PHY_FLOAT, false);
        field->setLocalScaling(btVector3(btScalar(0.25), btScalar(0.25), 1));
        w.add(std::move(field), 0, frame);
        break;
    }
    }
}

/// Ball; capsule along x, across, and upright.
std::unique_ptr<btCollisionShape> mover(int kind, double radius, double length) {
    const auto r = btScalar(radius), l = btScalar(length);
    if (kind == 0) return std::make_unique<btSphereShape>(r);
    if (kind == 1) return std::make_unique<btCapsuleShapeX>(r, l);
    if (kind == 2) return std::make_unique<btCapsuleShape>(r, l);
    return std::make_unique<btCapsuleShapeZ>(r, l);
}

struct Slid {
    double rises = 0, rises_at = 0; ///< most change of height, and speed of it
    double speed = 0;               ///< part of the speed that is left
    double aside = 0;
};

/// One slides from the middle for 4 m, or two seconds.
Slid slide(Ground ground, int kind, int number, double unevenness = 0) {
    scenes::Random random(static_cast<std::uint64_t>(100 * number + 10 * kind) + 3);
    const auto any = [&] { return btScalar(random.symmetric()); };
    // Every other ground is turned, and gravity with it.
    btTransform frame = at(0, 0, 0);
    if (number % 2)
        frame =
            btTransform(btQuaternion(btVector3(any(), any(), 1).normalized(), 3 * any()), btVector3(any(), any(), 3));
    TestWorld w;
    const btVector3 up = frame.getBasis().getColumn(2);
    w.world.setGravity(btScalar(-9.81) * up);
    add_ground(w, ground, frame, random, unevenness);
    const double radius = 0.05 * std::pow(4, random.symmetric()), length = 0.1 + 0.4 * std::fabs(random.symmetric());
    const double height = kind == 3 ? radius + length / 2 : radius;
    btRigidBody& body =
        w.add(mover(kind, radius, length), 1, frame * at(0.5 * random.symmetric(), 0.5 * random.symmetric(), height));
    if (kind == 3) body.setAngularFactor(0);
    for (const auto& b : w.bodies) b->setFriction(0);
    bullet::recommend(w.world);
    w.steps(40); // as deep as it will lie
    const double angle = number % 12 * std::numbers::pi / 6, speed = 2 * std::pow(8, random.symmetric());
    const btVector3 along = frame.getBasis() * btVector3(btScalar(std::cos(angle)), btScalar(std::sin(angle)), 0);
    const btVector3 across = up.cross(along), from = body.getWorldTransform().getOrigin();
    body.setAngularVelocity(btVector3(0, 0, 0));
    body.setLinearVelocity(btScalar(speed) * along);
    Slid found;
    const int steps = std::min(120, static_cast<int>(240 / speed));
    for (int i = 0; i < steps; ++i) {
        w.steps(1);
        const btVector3 way = body.getWorldTransform().getOrigin() - from;
        found.rises = std::max(found.rises, std::fabs(double(way.dot(up))));
        found.rises_at = std::max(found.rises_at, std::fabs(double(body.getLinearVelocity().dot(up))));
        found.aside = std::max(found.aside, std::fabs(double(way.dot(across))));
    }
    found.speed = double(body.getLinearVelocity().length()) / speed;
    return found;
}

TEST(Seams, NothingIsFelt) {
    for (const Ground ground : {Ground::junctions, Ground::bodies, Ground::strips, Ground::field})
        for (int kind = 0; kind < 4; ++kind)
            for (int number = 0; number < 12; ++number) {
                const Slid found = slide(ground, kind, number);
                const std::string which = "ground " + std::to_string(static_cast<int>(ground)) + ", mover "
                                          + std::to_string(kind) + ", " + std::to_string(number);
                EXPECT_LT(found.rises, 2e-5) << which;
                EXPECT_LT(found.rises_at, 2e-4) << which;
                EXPECT_NEAR(found.speed, 1, 3e-5) << which;
                EXPECT_LT(found.aside, 3e-5) << which;
            }
}

// The least radius is 12 mm, the margin of its speculative contacts 0.06 mm.
TEST(Seams, BodiesFlushWithinTheMarginAreOneFloor) {
    constexpr double unevenness = 1e-5;
    for (int kind = 0; kind < 4; ++kind)
        for (int number = 0; number < 12; ++number) {
            const Slid found = slide(Ground::bodies, kind, number, unevenness);
            EXPECT_LT(found.rises, 3e-5 + 2 * unevenness) << kind << ' ' << number;
            EXPECT_LT(found.rises_at, 4e-3) << kind << ' ' << number;
            EXPECT_NEAR(found.speed, 1, 1e-4) << kind << ' ' << number;
        }
}

/// A ball of 0.1 m radius at 2 m/s along x comes to what lies from x = 0 on.
struct Coming : TestWorld {
    explicit Coming(double speed = 2) {
        add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(-2, 0, -0.5)).setFriction(0);
        ball = &add(std::make_unique<btSphereShape>(btScalar(0.1)), 1, at(-0.6, 0.03, 0.1));
        ball->setFriction(0);
        bullet::recommend(world);
        steps(20);
        ball->setLinearVelocity(btVector3(btScalar(speed), 0, 0));
    }
    btVector3 place() const { return ball->getWorldTransform().getOrigin(); }
    btRigidBody* ball;
};

TEST(Seams, AStepIsAWall) {
    // What is left is its speed along the edge's tangent, of which 1 - height / radius is the cosine, less what it
    // takes to be lifted; off a high edge it flies, and loses as much again where it comes down.
    for (const auto& [height, least, most] : {std::array{0.005, 1.7, 1.9}, {0.03, 0.7, 1.2}, {0.2, 0.0, 0.05}}) {
        Coming w;
        w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(2, 0, -0.5 + height)).setFriction(0);
        w.steps(30);
        EXPECT_GE(double(w.ball->getLinearVelocity().length()), least) << height;
        EXPECT_LE(double(w.ball->getLinearVelocity().length()), most) << height;
    }
}

TEST(Seams, AGapIsNoFloor) {
    Coming w(0.3);
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(2.1, 0, -0.5)).setFriction(0);
    double least = 1;
    for (int i = 0; i < 180; ++i) {
        w.steps(1);
        least = std::min(least, double(w.place().z()));
    }
    EXPECT_LT(least, 0.095); // into it by 13 mm where it rests on both rims
    Coming none;
    none.steps(60);
    EXPECT_LT(double(none.place().z()), -0.5); // over the last rim
}

// A place where two solids meet at an angle is no seam: a valley has two walls.
TEST(Seams, AValleyHasBothItsWalls) {
    for (const double slope : {0.2, 0.6, 1.2}) {
        TestWorld w;
        for (const double side : {-1.0, 1.0}) {
            btTransform pose(btQuaternion(btVector3(0, 1, 0), btScalar(-side * slope)));
            pose.setOrigin(pose.getBasis() * btVector3(btScalar(side * 1.9), 0, btScalar(-0.5)));
            w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, pose);
        }
        const btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, at(0.1, 0, 0.5));
        bullet::recommend(w.world);
        w.steps(300);
        // On both planes, which meet at x = 0.
        EXPECT_NEAR(double(ball.getWorldTransform().getOrigin().x()), 0, 0.002) << slope;
        EXPECT_NEAR(double(ball.getWorldTransform().getOrigin().z()), 0.2 / std::cos(slope), 0.002) << slope;
        EXPECT_LT(double(ball.getLinearVelocity().length()), 1e-3) << slope;
    }
}

TEST(Seams, ABallBetweenTwoWallsStays) {
    for (const double room : {0.0, 1e-4, 0.02}) {
        TestWorld w;
        w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
        for (const double side : {-1.0, 1.0})
            w.add_mesh(Shape::make(box_mesh(1, 4, 1)), 0, at(side * (0.6 + room / 2), 0, 0.5));
        btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.1)), 1, at(0, -1, 0.1));
        for (const auto& b : w.bodies) b->setFriction(0);
        bullet::recommend(w.world);
        w.steps(20);
        ball.setLinearVelocity(btVector3(btScalar(0.5), 1, 0));
        w.steps(120);
        const btVector3 place = ball.getWorldTransform().getOrigin();
        EXPECT_NEAR(double(place.y()), 1, 0.01) << room;
        EXPECT_NEAR(double(place.z()), 0.1, 0.001) << room;
        EXPECT_LT(std::fabs(double(place.x())), room / 2 + 0.001) << room;
        EXPECT_NEAR(double(ball.getLinearVelocity().y()), 1, 0.001) << room;
    }
}

} // namespace
} // namespace raycontact::test
