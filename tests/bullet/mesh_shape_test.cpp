// SPDX-License-Identifier: Apache-2.0
#include "test_world.h"

#include <bullet_mesh.h>
#include <scenes/models/model.h>
#include <scenes/random.h>

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <vector>

namespace raycontact::test {
namespace {

struct Collect : btTriangleCallback {
    std::set<int> seen;
    void processTriangle(btVector3*, int, int index) override { EXPECT_TRUE(seen.insert(index).second); }
};

TEST(MeshShape, BoxHoldsEveryVertexAndFitsSnugly) {
    const auto big = Shape::make(scenes::scene_model("torus", 6000).mesh); // more vertices than are looked at singly
    scenes::Random random(5);
    for (const auto& shape : {torus(), big}) {
        for (const auto bounds : {bullet::Bounds::vertices, bullet::Bounds::box}) {
            const bullet::MeshShape mesh(shape, bounds);
            for (int i = 0; i < 50; ++i) {
                const auto number = [&] { return btScalar(random.symmetric()); };
                const btTransform pose(btQuaternion(number(), number(), number(), number()).normalized(),
                                       btVector3(number(), number(), number()));
                btVector3 low, high, least(9, 9, 9), most(-9, -9, -9);
                mesh.getAabb(pose, low, high);
                for (const Vec3& v : shape->vertices()) {
                    const btVector3 p = pose(btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z)));
                    least.setMin(p);
                    most.setMax(p);
                }
                for (int k = 0; k < 3; ++k) {
                    EXPECT_LE(low[k], least[k] + btScalar(1e-6));
                    EXPECT_GE(high[k], most[k] - btScalar(1e-6));
                    if (bounds == bullet::Bounds::vertices) {
                        EXPECT_LT(least[k] - low[k], btScalar(0.09));
                    }
                }
            }
        }
    }
}

// Bullet asks for every box in every step, asleep or not.
TEST(MeshShape, TheBoxOfABodyThatStandsStillIsMadeOnce) {
    TestWorld w;
    auto& shape = w.keep(std::make_unique<bullet::MeshShape>(torus()));
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    for (int i = 0; i < 1000; ++i) {
        bodies.push_back(std::make_unique<btRigidBody>(btScalar(1), nullptr, &shape, btVector3(1, 1, 1)));
        const int row = i / 10 % 10, layer = i / 100;
        bodies.back()->setWorldTransform(at(2 * (i % 10), 2 * row, 2 * layer));
        bodies.back()->setInterpolationWorldTransform(bodies.back()->getWorldTransform());
        w.world.addRigidBody(bodies.back().get());
        bodies.back()->forceActivationState(ISLAND_SLEEPING);
    }
    w.steps(40); // the cache grows
    const std::uint64_t before = shape.in_bullet()->bounds_made();
    w.steps(100);
    EXPECT_LT(shape.in_bullet()->bounds_made() - before, 100 * 1000 / 20u); // all of them would be 200 000

    // Those that move are the only ones whose boxes are made.
    for (int i = 0; i < 10; ++i) {
        bodies[0]->getWorldTransform().setOrigin(btVector3(0, 0, btScalar(-0.01 * i)));
        w.world.updateSingleAabb(bodies[0].get());
        btVector3 low, high, own_low, own_high;
        bodies[0]->getAabb(low, high);
        shape.in_bullet()->bounds(btTransform(bodies[0]->getWorldTransform()), own_low, own_high);
        EXPECT_EQ(low, own_low);
        EXPECT_EQ(high, own_high);
    }
    for (const auto& body : bodies) w.world.removeRigidBody(body.get());
}

TEST(MeshShape, TransformsThatComeAndGoLeaveTheBoxesOfOthers) {
    const bullet::MeshShape shape(torus());
    const btTransform stays = at(1, 2, 3);
    btVector3 low, high, again_low, again_high;
    shape.getAabb(stays, low, high);
    for (int i = 0; i < 1000; ++i) {
        const auto gone = std::make_unique<btTransform>(at(i, 0, 0));
        shape.getAabb(*gone, again_low, again_high);
        EXPECT_NEAR(double(again_low.x() - low.x()), i - 1, 1e-3);
    }
    const std::uint64_t before = shape.in_bullet()->bounds_made();
    EXPECT_EQ(before, 1001u);
    shape.getAabb(stays, again_low, again_high);
    EXPECT_EQ(shape.in_bullet()->bounds_made(), before);
    EXPECT_EQ(again_low, low);
    EXPECT_EQ(again_high, high);
}

TEST(MeshShape, NoMoreBoxesAreKeptThanMemoryBears) {
    const bullet::MeshShape shape(Shape::make(box_mesh(1, 1, 1)));
    const std::vector<btTransform> poses(200000, at(0, 0, 0));
    btVector3 low, high;
    for (const btTransform& pose : poses) shape.getAabb(pose, low, high);
    const std::uint64_t before = shape.in_bullet()->bounds_made();
    for (const btTransform& pose : poses) shape.getAabb(pose, low, high);
    EXPECT_GT(shape.in_bullet()->bounds_made() - before, poses.size() / 2);
}

TEST(MeshShape, ItsMeshMayOutliveIt) {
    std::weak_ptr<const Shape> shape;
    std::shared_ptr<const bullet::BulletMesh> in_bullet;
    {
        const bullet::MeshShape mesh(Shape::make(box_mesh(1, 1, 1)));
        shape = mesh.shape();
        in_bullet = mesh.in_bullet();
    }
    EXPECT_FALSE(shape.expired());
    EXPECT_EQ(in_bullet->overlapping(btVector3(-1, -1, -1), btVector3(1, 1, 0)).size(), 10u); // not those of the top
}

TEST(MeshShape, ABoxTakesFewLooks) {
    const auto looks = [](std::uint32_t triangles) {
        const auto shape = Shape::make(scenes::scene_model("torus", triangles).mesh);
        return bullet::BulletMesh(shape).bounds_size();
    };
    EXPECT_EQ(looks(600), torus()->vertices().size());
    for (const std::uint32_t triangles : {2000u, 2400u, 6000u, 50000u}) EXPECT_LE(looks(triangles), 1024u) << triangles;
}

TEST(MeshShape, GivesEachTriangleInABoxOnce) {
    const bullet::MeshShape mesh(torus());
    Collect all, some;
    mesh.processAllTriangles(&all, btVector3(-9, -9, -9), btVector3(9, 9, 9));
    EXPECT_EQ(all.seen.size(), torus()->triangles().size());

    const btVector3 low(0, btScalar(-0.3), btScalar(-0.1)), high(btScalar(0.5), btScalar(0.3), btScalar(0.2));
    mesh.processAllTriangles(&some, low, high);
    std::set<int> expected;
    for (std::size_t t = 0; t < torus()->triangles().size(); ++t) {
        btVector3 a(9, 9, 9), b(-9, -9, -9);
        for (const std::uint32_t v : torus()->triangles()[t]) {
            const Vec3& p = torus()->vertices()[v];
            a.setMin(btVector3(btScalar(p.x), btScalar(p.y), btScalar(p.z)));
            b.setMax(btVector3(btScalar(p.x), btScalar(p.y), btScalar(p.z)));
        }
        bool overlap = true;
        for (int k = 0; k < 3; ++k) overlap = overlap && a[k] <= high[k] && low[k] <= b[k];
        if (overlap) expected.insert(int(torus()->triangle_index()[t]));
    }
    EXPECT_EQ(some.seen, expected);
    EXPECT_GT(expected.size(), 20u);
    EXPECT_LT(expected.size(), torus()->triangles().size());
}

TEST(MeshShape, BulletTakesItForAConcaveShape) {
    const bullet::MeshShape mesh(torus());
    EXPECT_TRUE(mesh.isConcave());
    EXPECT_FALSE(mesh.isConvex());
    EXPECT_EQ(mesh.getMargin(), btScalar(0));
}

} // namespace
} // namespace raycontact::test
