// SPDX-License-Identifier: Apache-2.0
// Every combination that Bullet would let fall through in silence, and its convex shapes: bodies must rest.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

namespace raycontact::test {
namespace {

constexpr double still = 0.05; // m/s

/// Lets the body fall and settle; its lowest point must then stay at the surface's height.
void expect_rest(TestWorld& w, const btRigidBody& body, double surface, double tolerance = 0.02, double speed = still) {
    w.steps(180);
    for (int i = 0; i < 60; ++i) {
        w.steps(1);
        EXPECT_LT(double(body.getLinearVelocity().length()), speed) << "step " << i;
    }
    btVector3 low, high;
    body.getCollisionShape()->getAabb(body.getWorldTransform(), low, high);
    EXPECT_NEAR(double(low.z()), surface, tolerance);
    EXPECT_GT(w.touching(), 0);
}

std::unique_ptr<btTriangleMesh> sheet(double half) {
    auto mesh = std::make_unique<btTriangleMesh>();
    const btScalar h = btScalar(half);
    for (int i = -2; i < 2; ++i) {
        for (int j = -2; j < 2; ++j) {
            const btScalar x = btScalar(i) * h / 2, y = btScalar(j) * h / 2, s = h / 2;
            mesh->addTriangle(btVector3(x, y, 0), btVector3(x + s, y, 0), btVector3(x + s, y + s, 0));
            mesh->addTriangle(btVector3(x, y, 0), btVector3(x + s, y + s, 0), btVector3(x, y + s, 0));
        }
    }
    return mesh;
}

std::unique_ptr<btTriangleMesh> bullet_mesh(const Mesh& mesh) {
    auto out = std::make_unique<btTriangleMesh>();
    const auto v = [&](std::uint32_t i) {
        const Vec3& p = mesh.vertices[i];
        return btVector3(btScalar(p.x), btScalar(p.y), btScalar(p.z));
    };
    for (const auto& t : mesh.triangles) out->addTriangle(v(t[0]), v(t[1]), v(t[2]));
    return out;
}

TEST(Rest, OnOurMesh) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    expect_rest(w, w.add_mesh(table(), 5, at(0, 0, 0.6)), 0);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 1u);
}

TEST(Rest, OnPlane) {
    TestWorld w;
    w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0.25)), 0, at(0, 0, -0.25));
    expect_rest(w, w.add_mesh(table(), 5, at(0, 0, 0.6)), 0);
}

TEST(Rest, TorusOnTiltedPlaneObject) {
    TestWorld w;
    // The plane's own normal points along x; its object turns it up.
    btTransform pose = at(0, 0, 0);
    pose.setRotation(btQuaternion(btVector3(0, 1, 0), -SIMD_HALF_PI));
    w.add(std::make_unique<btStaticPlaneShape>(btVector3(1, 0, 0), btScalar(0)), 0, pose);
    expect_rest(w, w.add_mesh(torus(), 5, at(0, 0, 0.8)), 0);
}

TEST(Rest, OnBulletsBox) {
    for (const bool speculative : {false, true}) {
        Settings settings;
        if (!speculative) settings.speculative = Speculative::off;
        TestWorld w(settings);
        w.add(std::make_unique<btBoxShape>(btVector3(3, 3, btScalar(0.5))), 0, at(0, 0, -0.5));
        expect_rest(w, w.add_mesh(table(), 5, at(0, 0, 0.6)), 0);
        // The plane of the box's face knows what touches alone.
        EXPECT_EQ(w.dispatcher.stats().plane_pairs, speculative ? 0u : 1u);
        EXPECT_EQ(w.dispatcher.stats().mesh_pairs, speculative ? 1u : 0u);
    }
}

TEST(Rest, OnHeightField) {
    const std::vector<btScalar> heights(11 * 11, btScalar(0));
    for (const bool flip : {false, true}) {
        TestWorld w;
        w.add(std::make_unique<btHeightfieldTerrainShape>(11, 11, heights.data(), btScalar(-1), btScalar(1), 2, flip),
              0, at(0, 0, 0));
        expect_rest(w, w.add_mesh(table(), 5, at(0.03, 0.07, 0.6)), 0);
    }
}

TEST(Rest, OnScaledHeightField) {
    std::vector<btScalar> heights(9 * 9, btScalar(0.5));
    TestWorld w;
    auto field = std::make_unique<btHeightfieldTerrainShape>(9, 9, heights.data(), btScalar(-1), btScalar(1), 2, false);
    field->setLocalScaling(btVector3(btScalar(0.7), btScalar(0.7), btScalar(0.4)));
    w.add(std::move(field), 0, at(0, 0, 0));
    expect_rest(w, w.add_mesh(table(), 5, at(0.03, 0.07, 0.8)), 0.2);
}

TEST(Rest, OnCompoundOfBoxes) {
    TestWorld w;
    auto compound = std::make_unique<btCompoundShape>();
    btBoxShape& box = w.keep(std::make_unique<btBoxShape>(btVector3(1, 2, btScalar(0.5))));
    compound->addChildShape(at(-1, 0, -0.5), &box);
    compound->addChildShape(at(1, 0, -0.5), &box);
    w.add(std::move(compound), 0, at(0, 0, 0));
    expect_rest(w, w.add_mesh(table(), 5, at(0, 0, 0.6)), 0);
}

TEST(Rest, OnCompoundOfMeshAndBox) {
    TestWorld w;
    auto compound = std::make_unique<btCompoundShape>();
    auto& mesh = w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(2, 4, 1))));
    auto& box = w.keep(std::make_unique<btBoxShape>(btVector3(1, 2, btScalar(0.5))));
    compound->addChildShape(at(-1, 0, -0.5), &mesh);
    compound->addChildShape(at(1, 0, -0.5), &box);
    w.add(std::move(compound), 0, at(0, 0, 0));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.6));
    expect_rest(w, body, 0);
    EXPECT_LT(body.getWorldTransform().getBasis()[2].z(), btScalar(1.01)); // and it stands level: both children carry
    EXPECT_GT(body.getWorldTransform().getBasis()[2].z(), btScalar(0.999));
}

// Tiles of one compound, or a body each: the same contacts, of the tiles near by alone.
TEST(Rest, OnCompoundOfManyTiles) {
    TestWorld one, each;
    const auto tile = Shape::make(box_mesh(0.5, 0.5, 0.2));
    auto floor = std::make_unique<btCompoundShape>();
    auto& mesh = one.keep(std::make_unique<bullet::MeshShape>(tile));
    std::vector<btTransform> poses;
    for (int i = 0; i < 20; ++i)
        for (int k = 0; k < 20; ++k) {
            const btTransform pose = at(0.5 * i - 5, 0.5 * k - 5, -0.1);
            floor->addChildShape(pose, &mesh);
            poses.push_back(pose);
        }
    // The table is body a of each pair in both worlds.
    btRigidBody& in_one = one.add_mesh(table(), 5, at(0, 0, 0.5));
    one.add(std::move(floor), 0, at(0, 0, 0));
    btRigidBody& in_each = each.add_mesh(table(), 5, at(0, 0, 0.5));
    for (const btTransform& pose : poses) each.add_mesh(tile, 0, pose);
    std::uint64_t contacts = 0;
    for (int i = 0; i < 50; ++i) {
        btTransform pose = at(0.13 * i - 3, 0.3 - 0.07 * i, 0.38 - 0.002 * i);
        pose.setRotation(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(0.02 * i)));
        in_one.setWorldTransform(pose);
        in_each.setWorldTransform(pose);
        one.world.performDiscreteCollisionDetection();
        each.world.performDiscreteCollisionDetection();
        ASSERT_EQ(one.dispatcher.scene().contacts().size(), each.dispatcher.scene().contacts().size()) << i;
        EXPECT_EQ(one.dispatcher.scene().stats().depth_max, each.dispatcher.scene().stats().depth_max) << i;
        EXPECT_LE(one.dispatcher.stats().mesh_pairs, 25u) << i;
        contacts += one.dispatcher.stats().contacts;
    }
    EXPECT_GT(contacts, 200u);
}

TEST(Rest, OnPlaneInsideCompound) {
    TestWorld w;
    auto compound = std::make_unique<btCompoundShape>();
    auto& plane = w.keep(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)));
    compound->addChildShape(at(0, 0, 0.5), &plane);
    w.add(std::move(compound), 0, at(0, 0, -0.5));
    expect_rest(w, w.add_mesh(table(), 5, at(0, 0, 0.6)), 0);
}

TEST(Rest, MovingCompoundOfMeshesOnMeshAndPlane) {
    for (const bool plane : {false, true}) {
        TestWorld w;
        if (plane)
            w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0, at(0, 0, 0));
        else
            w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
        auto compound = std::make_unique<btCompoundShape>();
        auto& mesh = w.keep(std::make_unique<bullet::MeshShape>(table()));
        compound->addChildShape(at(-0.6, 0, 0), &mesh);
        compound->addChildShape(at(0.6, 0, 0), &mesh);
        expect_rest(w, w.add(std::move(compound), 10, at(0, 0, 0.6)), 0);
    }
}

TEST(Rest, OnBvhTriangleMesh) {
    const auto triangles = sheet(3);
    TestWorld w;
    w.add(std::make_unique<btBvhTriangleMeshShape>(triangles.get(), true), 0, at(0, 0, 0));
    expect_rest(w, w.add_mesh(table(), 5, at(0.03, 0.07, 0.6)), 0);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 1u);
}

TEST(Rest, OnScaledBvhTriangleMesh) {
    const auto triangles = bullet_mesh(box_mesh(3, 3, 1));
    TestWorld w;
    auto& base = w.keep(std::make_unique<btBvhTriangleMeshShape>(triangles.get(), true));
    w.add(std::make_unique<btScaledBvhTriangleMeshShape>(&base, btVector3(2, 2, btScalar(0.5))), 0, at(0, 0, -0.25));
    expect_rest(w, w.add_mesh(table(), 5, at(0, 0, 0.6)), 0);
}

TEST(Rest, GImpactOnOursOnPlaneAndOnGImpact) {
    const auto triangles = bullet_mesh(table_mesh());
    const auto ground = bullet_mesh(box_mesh(6, 6, 1));
    for (int kind = 0; kind < 3; ++kind) {
        TestWorld w;
        if (kind == 0) w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
        if (kind == 1) w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0, at(0, 0, 0));
        if (kind == 2) {
            auto shape = std::make_unique<btGImpactMeshShape>(ground.get());
            shape->updateBound();
            w.add(std::move(shape), 0, at(0, 0, -0.5));
        }
        auto shape = std::make_unique<btGImpactMeshShape>(triangles.get());
        shape->setLocalScaling(btVector3(1, 1, btScalar(0.5)));
        shape->setMargin(0);
        shape->updateBound();
        expect_rest(w, w.add(std::move(shape), 5, at(0, 0, 0.4)), 0);
        EXPECT_EQ(w.dispatcher.stats().pairs, 1u);
    }
}

TEST(Rest, SphereAndBoxOnOurs) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    const btRigidBody& sphere = w.add(std::make_unique<btSphereShape>(btScalar(0.3)), 2, at(-1, 0, 0.5));
    const btVector3 half(btScalar(0.3), btScalar(0.3), btScalar(0.3));
    const btRigidBody& box = w.add(std::make_unique<btBoxShape>(half), 2, at(1, 0, 0.5));
    expect_rest(w, sphere, 0);
    expect_rest(w, box, 0);
}

TEST(Rest, SphereOnMovingMesh) {
    TestWorld w;
    w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0, at(0, 0, 0));
    w.add_mesh(table(), 20, at(0, 0, 0.41));
    expect_rest(w, w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, at(0, 0, 1.1)), 0.8, 0.03);
}

TEST(Rest, StackOfTables) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    w.add_mesh(table(), 5, at(0, 0, 0.45));
    w.add_mesh(table(), 5, at(0.05, 0.02, 1.3));
    expect_rest(w, w.add_mesh(table(), 5, at(0.02, 0.06, 2.15)), 1.6);
}

TEST(Rest, UnsupportedPairIsCounted) {
    /// A user's own concave shape: Bullet itself has nothing for it against a mesh.
    struct Strange : btStaticPlaneShape {
        Strange() : btStaticPlaneShape(btVector3(0, 0, 1), 0) { m_shapeType = FAST_CONCAVE_MESH_PROXYTYPE; }
    };
    TestWorld w;
    w.add(std::make_unique<Strange>(), 0, at(0, 0, 0));
    w.add_mesh(table(), 5, at(0, 0, 0.3));
    w.steps(1);
    EXPECT_EQ(w.dispatcher.stats().unsupported, 1u);
}

// Sheets of metal, dropped by 1 m, flat to upright: they lie on the slab, or stand on a side, and not in it, though
// where one end is hit the other is thrown down by more than the sheet is thick.
TEST(Rest, ThinPlatesLieOnTop) {
    constexpr double slop = 0.0003; // metres, as recommended
    for (const bool as_mesh : {true, false})
        for (const double thick : {0.001, 0.002, 0.003, 0.005})
            for (const double tilt : {0.0, 0.1, 0.3, 0.6, 1.0, 1.3, 1.5, 1.57})
                for (const int hertz : {60, 120, 240}) {
                    TestWorld w;
                    w.add_mesh(Shape::make(box_mesh(4, 4, 0.5)), 0, at(0, 0, -0.25));
                    btTransform pose = at(0, 0, 1);
                    pose.setRotation(btQuaternion(btVector3(1, 0, 0), btScalar(tilt)));
                    const btVector3 half(btScalar(0.15), btScalar(0.1), btScalar(thick / 2));
                    const btRigidBody& plate = as_mesh ? w.add_mesh(Shape::make(box_mesh(0.3, 0.2, thick)), 0.2, pose)
                                                       : w.add(std::make_unique<btBoxShape>(half), 0.2, pose);
                    bullet::recommend(w.world);
                    for (int i = 0; i < 5 * hertz; ++i) w.world.stepSimulation(btScalar(1.0 / hertz), 0);
                    const double up = std::fabs(double(plate.getWorldTransform().getBasis()[2][2]));
                    const double height = double(plate.getWorldTransform().getOrigin().z());
                    const double right = up > 0.5 ? thick / 2 : 0.1;
                    const bool lies = std::fabs(height - (right - slop)) <= slop && (up > 0.999 || up < 0.02)
                                      && double(plate.getLinearVelocity().length()) < 0.005;
                    EXPECT_TRUE(lies) << thick << ' ' << tilt << ' ' << hertz << ' ' << as_mesh;
                }
}

/// A profile with two legs, its centre of mass about the origin.
Mesh angle_mesh(double leg, double thick, double length) {
    const double middle = leg / 4;
    const std::array<std::array<double, 2>, 6> outline{
        {{0, 0}, {leg, 0}, {leg, thick}, {thick, thick}, {thick, leg}, {0, leg}}};
    Mesh mesh;
    for (const double z : {-length / 2, length / 2})
        for (const auto& [x, y] : outline) mesh.vertices.push_back({x - middle, y - middle, z});
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 5, 4}, {6, 7, 8}, {6, 8, 9}, {6, 9, 10}, {6, 10, 11}};
    for (std::uint32_t i = 0; i < 6; ++i) {
        const std::uint32_t j = (i + 1) % 6;
        mesh.triangles.push_back({i, j, j + 6});
        mesh.triangles.push_back({i, j + 6, i + 6});
    }
    return mesh;
}

// Thrown sheets and angles, turned any way, spinning: hardly one rests with a corner deeper in the slab than the slop
// (docs/limits.md).
TEST(Rest, ThinPartsThrownAnyWayLieOnTop) {
    std::mt19937 random(64);
    const auto part_of_one = [&] { return double(random()) / 4294967296.0; };
    const auto direction = [&] {
        const double z = 2 * part_of_one() - 1, turn = 6.2831853 * part_of_one(), r = std::sqrt(1 - z * z);
        return btVector3(btScalar(r * std::cos(turn)), btScalar(r * std::sin(turn)), btScalar(z));
    };
    std::size_t sunk = 0, parts = 0;
    for (int i = 0; i < 240; ++i) {
        const double thick = 0.001 * (1 + i % 5);
        Mesh mesh = i % 2 == 0 ? box_mesh(0.3, 0.2, thick) : angle_mesh(0.2, thick, 0.15);
        const auto shape = Shape::make(mesh);
        const int hertz = std::array{60, 120, 240}[std::size_t(i / 2) % 3];
        TestWorld w;
        w.add_mesh(Shape::make(box_mesh(8, 8, 0.5)), 0, at(0, 0, -0.25));
        btTransform pose = at(0, 0, 0.6);
        pose.setRotation(btQuaternion(direction(), btScalar(3.1 * part_of_one())));
        btRigidBody& part = w.add_mesh(shape, 0.2, pose);
        part.setAngularVelocity(btScalar(25 * part_of_one()) * direction());
        part.setLinearVelocity(btVector3(0, 0, btScalar(-4 * part_of_one())));
        bullet::recommend(w.world);
        for (int k = 0; k < 4 * hertz; ++k) w.world.stepSimulation(btScalar(1.0 / hertz), 0);
        double lowest = 1;
        for (const Vec3& v : mesh.vertices)
            lowest = std::min(
                lowest,
                double((part.getWorldTransform() * btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z))).z()));
        ++parts;
        sunk += lowest < -0.001;
        if (lowest < -0.001) std::printf("sunk %d by %g mm, %d Hz, %g thick\n", i, -1000 * lowest, hertz, thick);
    }
    std::printf("[ counts ] %zu of %zu parts sunk\n", sunk, parts);
    EXPECT_LE(sunk, parts / 48);
}

} // namespace
} // namespace raycontact::test
