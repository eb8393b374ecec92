// SPDX-License-Identifier: Apache-2.0
// Balls and capsules against meshes, in closed form: against brute force, and rolling.
#include "test_world.h"

#include <objects.h>
#include <raycontact/collide.h>
#include <round.h>
#include <scenes/models/model.h>
#include <scenes/random.h>
#include <vectors.h>

#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace raycontact::test {
namespace {

/// In Bullet's terms.
struct Found {
    btVector3 point, normal;
    btScalar distance;
};

std::vector<Found> contacts(const std::shared_ptr<const Shape>& mesh, const btCollisionShape& shape,
                            const btTransform& pose, double reach = 0, const btTransform& mesh_pose = at(0, 0, 0)) {
    const Pose place = bullet::to_pose(mesh_pose);
    const std::vector<Obstacle> obstacles{{Facets(*mesh), place, place}};
    std::vector<RoundContact> rounds;
    round_contacts(bullet::round_of(shape), bullet::to_pose(pose), {}, obstacles, reach, rounds);
    std::vector<Found> found;
    found.reserve(rounds.size());
    for (const RoundContact& c : rounds)
        found.push_back({bullet::to_bullet(c.point), bullet::to_bullet(c.normal), btScalar(c.distance)});
    return found;
}

/// Distance of a point from the mesh's surface, by many points of every triangle.
double away(const Shape& shape, const btVector3& p) {
    double least = 1e30;
    for (const auto& t : shape.triangles()) {
        const Vec3 &a = shape.vertices()[t[0]], &b = shape.vertices()[t[1]], &c = shape.vertices()[t[2]];
        constexpr int parts = 24;
        for (int i = 0; i <= parts; ++i)
            for (int k = 0; i + k <= parts; ++k) {
                const double u = double(i) / parts, v = double(k) / parts, w = 1 - u - v;
                least = std::min(least, std::hypot(w * a.x + u * b.x + v * c.x - double(p.x()),
                                                   w * a.y + u * b.y + v * c.y - double(p.y()),
                                                   w * a.z + u * b.z + v * c.z - double(p.z())));
            }
    }
    return least;
}

TEST(Round, DeepestIsTheDistanceFromTheSurface) {
    const auto mesh = Shape::make(scenes::scene_model("torus", 200).mesh);
    scenes::Random random(5);
    const btSphereShape ball(btScalar(0.15));
    int touching = 0;
    for (int i = 0; i < 300; ++i) {
        const btVector3 centre(btScalar(0.8 * random.symmetric()), btScalar(0.8 * random.symmetric()),
                               btScalar(0.3 * random.symmetric()));
        const auto found = contacts(mesh, ball, btTransform(btQuaternion::getIdentity(), centre));
        const double expected = away(*mesh, centre);
        if (expected > 0.15 + 0.01) {
            EXPECT_TRUE(found.empty()) << i;
            continue;
        }
        if (expected > 0.15 - 0.01) continue; // the reference is of points
        ASSERT_FALSE(found.empty()) << i;
        ++touching;
        double least = 1e30;
        for (const auto& c : found) {
            least = std::min(least, std::fabs(double(c.distance + ball.getRadius())));
            EXPECT_NEAR(double(c.normal.length()), 1, 1e-4);
            EXPECT_LT(double((c.point + c.normal * (c.distance + ball.getRadius()) - centre).length()), 1e-4);
            EXPECT_LT(away(*mesh, c.point), 0.01);
        }
        EXPECT_NEAR(least, expected, 0.005) << i;
    }
    EXPECT_GT(touching, 50);
}

TEST(Round, OnAFlatFloorThereIsOneContact) {
    const btSphereShape ball(btScalar(0.3));
    // Cut into many triangles; the ball rests on faces, edges and corners of them.
    Mesh sheet;
    for (std::uint32_t i = 0; i <= 20; ++i)
        for (std::uint32_t k = 0; k <= 20; ++k) sheet.vertices.push_back({0.1 * i - 1, 0.1 * k - 1, 0});
    for (std::uint32_t i = 0; i < 20; ++i)
        for (std::uint32_t k = 0; k < 20; ++k) {
            const std::uint32_t v = 21 * i + k;
            sheet.triangles.push_back({v, v + 21, v + 22});
            sheet.triangles.push_back({v, v + 22, v + 1});
        }
    const auto floor = Shape::make(sheet);
    for (int i = 0; i < 100; ++i) {
        const auto found = contacts(floor, ball, at(-0.2 + 0.004 * i, 0.001 * i, 0.29));
        ASSERT_EQ(found.size(), 1u) << i;
        EXPECT_NEAR(double(found[0].distance), -0.01, 1e-5);
        EXPECT_NEAR(double(found[0].normal.z()), 1, 1e-5);
    }
}

TEST(Round, CapsuleOnAFloorARimAndACorner) {
    const auto floor = Shape::make(box_mesh(4, 4, 1));
    const btCapsuleShapeX capsule(btScalar(0.2), 1);
    auto found = contacts(floor, capsule, at(0, 0, 0.69));
    ASSERT_EQ(found.size(), 2u); // both ends
    for (const auto& c : found) {
        EXPECT_NEAR(double(c.distance), -0.01, 1e-5);
        EXPECT_NEAR(std::fabs(double(c.point.x())), 0.5, 1e-5);
    }
    found = contacts(floor, capsule, at(2.2, 0, 0.69)); // one end beyond the rim: the rim carries its side
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(double(found[1].point.x()), 2, 1e-5);
    EXPECT_NEAR(double(found[1].normal.z()), 1, 1e-5);
    EXPECT_NEAR(double(found[1].distance), -0.01, 1e-5);
    // Its side on a corner of the box that points up: turned, the box has its corner at (0, 0, sqrt 3 / 2).
    const auto box = Shape::make(box_mesh(1, 1, 1));
    btTransform tip = at(0, 0, 0);
    tip.setRotation(shortestArcQuat(btVector3(1, 1, 1).normalized(), btVector3(0, 0, 1)));
    const auto on_tip = contacts(box, capsule, at(0.1, 0, std::sqrt(3) / 2 + 0.19), 0, tip);
    ASSERT_EQ(on_tip.size(), 1u);
    EXPECT_NEAR(double(on_tip[0].distance), -0.01, 1e-4);
    EXPECT_NEAR(double(on_tip[0].normal.z()), 1, 1e-4);
}

TEST(Round, CentreInsideIsPushedOutTheNearestWay) {
    const auto box = Shape::make(box_mesh(1, 1, 1));
    const btSphereShape ball(btScalar(0.3));
    const auto found = contacts(box, ball, at(0.1, 0, 0.4));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(double(found[0].normal.z()), 1, 1e-5);
    EXPECT_NEAR(double(found[0].distance), -0.4, 1e-5);
    EXPECT_TRUE(contacts(box, ball, at(0, 0, 0.81)).empty());
    EXPECT_EQ(contacts(box, ball, at(0, 0, 0.81), 0.02).size(), 1u);
    // However deep it is, alone or as the end of a capsule; but not in the air within the box of a mesh.
    const btSphereShape marble(btScalar(0.05));
    for (const double z : {0.4, 0.2, -0.2, -0.45}) {
        const auto deep = contacts(box, marble, at(0.02, 0.01, z));
        ASSERT_EQ(deep.size(), 1u) << z;
        EXPECT_NEAR(double(deep[0].distance), -(0.5 - std::fabs(z) + 0.05), 1e-5) << z;
        EXPECT_NEAR(double(deep[0].normal.z()), z > 0 ? 1 : -1, 1e-5) << z;
    }
    const auto ring = torus();
    EXPECT_TRUE(contacts(ring, marble, at(0, 0, 0)).empty());
    const auto capsule_in = contacts(box, btCapsuleShapeZ(btScalar(0.05), btScalar(0.9)), at(0, 0, 0.75));
    ASSERT_EQ(capsule_in.size(), 1u); // its upper end is outside
    EXPECT_NEAR(double(capsule_in[0].distance), -0.25, 1e-5);
    // The far side of a thin plate is not met.
    const auto plate = Shape::make(box_mesh(2, 2, 0.01));
    EXPECT_EQ(contacts(plate, ball, at(0, 0, 0.28)).size(), 1u);
}

TEST(Round, ARadiusOfNothingIsPushedOut) {
    for (const bool ball : {true, false}) {
        TestWorld w;
        const btRigidBody& box = w.add_mesh(Shape::make(box_mesh(4, 4, 4)), 0, at(0, 0, 0));
        std::unique_ptr<btCollisionShape> shape = std::make_unique<btCapsuleShape>(btScalar(0), btScalar(1));
        if (ball) shape = std::make_unique<btSphereShape>(btScalar(0));
        const auto found = contacts(Shape::make(box_mesh(4, 4, 4)), *shape, at(0.2, 0.1, 1.7));
        ASSERT_EQ(found.size(), ball ? 1u : 2u);
        EXPECT_NEAR(double(found[0].distance), -0.3, 1e-5);
        EXPECT_NEAR(double(found[0].normal.z()), 1, 1e-5);
        w.add(std::move(shape), 1, at(0.2, 0.1, 1.7));
        w.steps(1);
        EXPECT_EQ(w.dispatcher.stats().contacts, found.size()) << ball;
        EXPECT_EQ(box.getWorldTransform(), at(0, 0, 0));
    }
}

TEST(Round, AxisThroughAPlateIsPushedOut) {
    const auto plate = Shape::make(box_mesh(2, 2, 0.01));
    const btCapsuleShapeZ capsule(btScalar(0.1), 2);
    EXPECT_EQ(contacts(plate, capsule, at(0, 0, 0)).size(), 1u); // through a diagonal
    auto found = contacts(plate, capsule, at(0.3, 0.1, 0.2));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(double(found[0].normal.x()), 1, 1e-5); // past the nearest edge
    EXPECT_NEAR(double(found[0].distance), -(0.7 + 0.1), 1e-5);
    found = contacts(plate, capsule, at(0.3, 0.1, 0.6)); // upwards is nearer: its lower end is 0.4 below
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(double(found[0].normal.z()), 1, 1e-5);
    EXPECT_NEAR(double(found[0].distance), -(0.405 + 0.1), 1e-5);
    // And it gets there.
    TestWorld w;
    w.world.setGravity(btVector3(0, 0, 0));
    w.add_mesh(Shape::make(box_mesh(2, 2, 0.01)), 0, at(0, 0, 0));
    const btRigidBody& body =
        w.add(std::make_unique<btCapsuleShapeZ>(btScalar(0.1), btScalar(2)), 1, at(0.3, 0.1, 0.2));
    w.steps(120);
    for (const auto& c : contacts(plate, capsule, body.getWorldTransform())) EXPECT_GT(double(c.distance), -0.01);
    EXPECT_GT(double(body.getWorldTransform().getOrigin().x()), 1);
}

TEST(Round, RodAcrossAWallIsLiftedOntoIt) {
    const auto wall = Shape::make(box_mesh(4, 0.1, 1));
    const btCapsuleShape rod(btScalar(0.02), 1);
    for (const double below : {0.01, 0.03, 0.2}) {
        const auto found = contacts(wall, rod, at(0.3, 0, 0.5 - below));
        ASSERT_EQ(found.size(), 1u) << below;
        EXPECT_NEAR(double(found[0].normal.z()), 1, 1e-5) << below;
        EXPECT_NEAR(double(found[0].distance), -(below + 0.02), 1e-5) << below;
        EXPECT_LT(away(*wall, found[0].point), 0.05) << below;
    }
    TestWorld w;
    w.add_mesh(wall, 0, at(0, 0, 0));
    const btRigidBody& body = w.add(std::make_unique<btCapsuleShape>(btScalar(0.02), btScalar(1)), 1, at(0.3, 0, 0.47));
    w.steps(60);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.52, 0.01);
    // Of two walls that it goes through it is out when it is out of both.
    const auto ring = torus();
    const auto both = contacts(ring, btCapsuleShapeX(btScalar(0.02), btScalar(3)), at(0, 0, 0.01));
    ASSERT_EQ(both.size(), 2u);
    for (const auto& c : both) EXPECT_GT(double(c.normal.z()), 0.9); // facets
}

// Of many poses, on a solid with a hole: a thin rod always has a contact, and moved by the deepest one again and
// again it gets out.
TEST(Round, NoAxisInsideIsWithoutAWayOut) {
    const auto mesh = torus();
    const btCapsuleShapeX rod(btScalar(0.01), 2);
    const auto is_inside = [&](const btTransform& pose) {
        constexpr int parts = 100;
        for (int i = 0; i <= parts; ++i) {
            const btVector3 p = pose(btVector3(btScalar(2.0 * i / parts - 1), 0, 0));
            if (contains(*mesh, {double(p.x()), double(p.y()), double(p.z())})) return true;
        }
        return false;
    };
    scenes::Random random(11);
    int inside = 0, stuck = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto any = [&] { return btScalar(random.symmetric()); };
        const btVector3 axis(any(), any(), any() + btScalar(1e-3)), centre(any(), any(), any());
        btTransform pose(btQuaternion(axis.normalized(), 3 * any()), centre);
        if (!is_inside(pose)) continue;
        ++inside;
        int moves = 0;
        for (; moves < 50 && is_inside(pose); ++moves) {
            const auto found = contacts(mesh, rod, pose);
            ASSERT_FALSE(found.empty()) << i;
            const auto& deepest = *std::min_element(
                found.begin(), found.end(), [](const auto& x, const auto& y) { return x.distance < y.distance; });
            pose.setOrigin(pose.getOrigin() - deepest.distance * deepest.normal);
        }
        stuck += moves == 50;
    }
    EXPECT_GT(inside, 100);
    EXPECT_LE(50 * stuck, inside); // wedged in the hole, where only a turn helps
}

TEST(Round, AxisThroughAnOpenSheetIsPushedToItsFront) {
    Mesh sheet;
    sheet.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    const auto floor = Shape::make(sheet);
    for (const double height : {0.3, 0.0, -0.3}) {
        const auto found = contacts(floor, btCapsuleShapeZ(btScalar(0.05), btScalar(1)), at(0.2, 0.1, height));
        ASSERT_EQ(found.size(), 1u) << height;
        EXPECT_NEAR(double(found[0].normal.z()), 1, 1e-5);
        EXPECT_NEAR(double(found[0].distance), height - 0.5 - 0.05, 1e-5);
    }
    // Beside it, and with an end just behind it, which has its contact by itself.
    EXPECT_TRUE(contacts(floor, btCapsuleShapeZ(btScalar(0.05), btScalar(1)), at(1.2, 0.1, 0)).empty());
    EXPECT_EQ(contacts(floor, btCapsuleShapeZ(btScalar(0.05), btScalar(1)), at(0.2, 0.1, 0.48)).size(), 1u);
}

/// Rolls without sliding along x for 10 m; gives the way sideways and the speed that is left.
void roll(TestWorld& w, btRigidBody& ball, double radius, double& aside, double& speed) {
    ball.setLinearVelocity(btVector3(2, 0, 0));
    ball.setAngularVelocity(btVector3(0, btScalar(2 / radius), 0));
    const btVector3 from = ball.getWorldTransform().getOrigin();
    for (int i = 0; i < 900 && ball.getWorldTransform().getOrigin().x() - from.x() < 10; ++i) w.steps(1);
    const btVector3 way = ball.getWorldTransform().getOrigin() - from;
    EXPECT_GE(double(way.x()), 10);
    EXPECT_LT(std::fabs(double(way.z())), 0.01);
    aside = std::fabs(double(way.y()));
    speed = double(ball.getLinearVelocity().x());
}

TEST(Round, BallRollsStraightOnEveryFloor) {
    btTriangleMesh sheet;
    for (int i = 0; i < 60; ++i)
        for (int k = 0; k < 12; ++k) {
            // Uneven triangles: no edge runs along the way.
            const auto corner = [&](int a, int b) {
                return btVector3(btScalar(0.23 * a + 0.05 * b - 1), btScalar(0.21 * b + 0.03 * a - 2), 0);
            };
            sheet.addTriangle(corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), true);
            sheet.addTriangle(corner(i, k), corner(i + 1, k + 1), corner(i, k + 1), true);
        }
    const btVector3 middle(0, 0, 0);
    const btScalar radius = btScalar(0.3);
    for (const bool slab : {true, false}) {
        for (const bool moved : {false, true}) { // a multi-sphere of one ball is a ball
            TestWorld w;
            if (slab)
                w.add_mesh(Shape::make(box_mesh(30, 6, 1)), 0, at(12, 0, -0.5));
            else
                w.add(std::make_unique<btBvhTriangleMeshShape>(&sheet, true), 0, at(0, 0, 0));
            std::unique_ptr<btCollisionShape> shape = std::make_unique<btSphereShape>(radius);
            if (moved) shape = std::make_unique<btMultiSphereShape>(&middle, &radius, 1);
            btRigidBody& ball = w.add(std::move(shape), 1, at(0, 0, 0.3));
            double aside = 1, speed = 0;
            roll(w, ball, double(radius), aside, speed);
            EXPECT_LT(aside, 0.001) << slab << moved;
            EXPECT_NEAR(speed, 2, 0.02) << slab << moved;
            EXPECT_EQ(w.dispatcher.stats().round_pairs, 1u);
        }
    }
}

} // namespace
} // namespace raycontact::test
