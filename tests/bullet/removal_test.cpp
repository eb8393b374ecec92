// SPDX-License-Identifier: Apache-2.0
// Bodies and shapes come and go while others touch them; run under AddressSanitizer too.
#include "test_world.h"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <new>
#include <utility>

namespace raycontact::test {
namespace {

TEST(Removal, LeavesNoManifoldAndNoBody) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(-0.01)), 0, at(0, 0, 0));
    for (int i = 0; i < 6; ++i) w.add_mesh(table(), 5, at(0.3 * (i % 2), 0.2 * (i % 3), 0.45 + 0.7 * i));
    w.steps(60);
    EXPECT_GT(w.touching(), 3);
    EXPECT_EQ(w.dispatcher.scene().body_count(), 7u);
    for (int i = 0; i < 6; ++i) {
        const btRigidBody* gone = w.bodies.back().get();
        w.remove(*w.bodies.back());
        for (int k = 0; k < w.dispatcher.getNumManifolds(); ++k) {
            EXPECT_NE(w.dispatcher.getManifoldByIndexInternal(k)->getBody0(), gone);
            EXPECT_NE(w.dispatcher.getManifoldByIndexInternal(k)->getBody1(), gone);
        }
        w.steps(5);
    }
    EXPECT_EQ(w.dispatcher.getNumManifolds(), 0);
    EXPECT_EQ(w.dispatcher.scene().body_count(), 0u); // the ground has nobody to meet
}

/// A body takes a shape, lies down with it, and then another of the same class made where the first was.
class ReplacedInPlace {
public:
    template <class S, class... Arguments>
    S& make(Arguments&&... arguments) {
        static_assert(sizeof(S) <= sizeof place_);
        static_assert(alignof(S) <= 16);
        if (shape_) shape_->~btCollisionShape();
        S* made = new (static_cast<void*>(place_)) S(std::forward<Arguments>(arguments)...);
        shape_ = made;
        return *made;
    }
    /// How high the body's origin comes to lie.
    double rest(int steps = 120) {
        body_.setCollisionShape(shape_);
        body_.setWorldTransform(at(0, 0, 0.6));
        body_.setLinearVelocity(btVector3(0, 0, 0));
        body_.setAngularVelocity(btVector3(0, 0, 0));
        w_.steps(steps);
        return double(body_.getWorldTransform().getOrigin().z());
    }
    ~ReplacedInPlace() {
        w_.remove(body_);
        shape_->~btCollisionShape();
    }
    ReplacedInPlace() { w_.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5)); }
    ReplacedInPlace(const ReplacedInPlace&) = delete;
    ReplacedInPlace& operator=(const ReplacedInPlace&) = delete;

private:
    TestWorld w_;
    btRigidBody& body_ = w_.add(std::make_unique<btBoxShape>(btVector3(1, 1, 1)), 5, at(0, 0, 30));
    alignas(16) std::byte place_[1024];
    btCollisionShape* shape_ = nullptr;
};

void add_corners(btConvexHullShape& hull, double half) {
    for (int i = 0; i < 8; ++i)
        hull.addPoint(
            btVector3(btScalar(i & 1 ? half : -half), btScalar(i & 2 ? half : -half), btScalar(i & 4 ? half : -half)));
}

TEST(Removal, ANewHullAtTheAddressOfTheOldOneIsSeen) {
    ReplacedInPlace body;
    add_corners(body.make<btConvexHullShape>(), 0.3);
    EXPECT_NEAR(body.rest(), 0.3, 0.02);
    add_corners(body.make<btConvexHullShape>(), 0.5); // as many points
    EXPECT_NEAR(body.rest(), 0.5, 0.02);
}

TEST(Removal, ANewBoxAtTheAddressOfTheOldOneIsSeen) {
    ReplacedInPlace body;
    for (const double half : {0.3, 0.5}) {
        body.make<btBoxShape>(btVector3(1, 1, btScalar(half)));
        EXPECT_NEAR(body.rest(), half, 0.02);
    }
}

TEST(Removal, ANewCylinderOrConeAtTheAddressOfTheOldOneIsSeen) {
    ReplacedInPlace body;
    const btVector3 half(btScalar(0.5), btScalar(0.3), btScalar(0.5));
    body.make<btCylinderShape>(half); // stands along y, so it lies on its side
    EXPECT_NEAR(body.rest(), 0.5, 0.02);
    body.make<btCylinderShape>(btVector3(btScalar(0.4), btScalar(0.3), btScalar(0.4)));
    EXPECT_NEAR(body.rest(), 0.4, 0.02);
    body.make<btCylinderShapeZ>(btVector3(btScalar(0.4), btScalar(0.4), btScalar(0.3))); // another class
    EXPECT_NEAR(body.rest(), 0.3, 0.02);
    body.make<btConeShapeZ>(btScalar(0.5), btScalar(0.4)); // half its height under its origin
    EXPECT_NEAR(body.rest(), 0.2, 0.02);
    body.make<btConeShapeZ>(btScalar(0.5), btScalar(0.6));
    EXPECT_NEAR(body.rest(), 0.3, 0.02);
}

TEST(Removal, ANewBallCapsuleOrMultiSphereAtTheAddressOfTheOldOneIsSeen) {
    ReplacedInPlace body;
    for (const double radius : {0.3, 0.5}) {
        body.make<btSphereShape>(btScalar(radius));
        EXPECT_NEAR(body.rest(), radius, 0.01);
    }
    for (const double radius : {0.2, 0.4}) {
        body.make<btCapsuleShapeX>(btScalar(radius), btScalar(1));
        EXPECT_NEAR(body.rest(), radius, 0.01);
    }
    // Three balls flat on the floor, so that no edge of two speaks.
    const btVector3 centres[] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    for (const double radius : {0.2, 0.35}) {
        const btScalar radii[] = {btScalar(radius), btScalar(radius), btScalar(radius)};
        body.make<btMultiSphereShape>(centres, radii, 3);
        EXPECT_NEAR(body.rest(), radius, 0.02);
    }
}

TEST(Removal, ANewMeshShapeAtTheAddressOfTheOldOneIsSeen) {
    ReplacedInPlace body;
    for (const double height : {0.6, 0.9}) {
        body.make<bullet::MeshShape>(Shape::make(box_mesh(1, 1, height)));
        EXPECT_NEAR(body.rest(), height / 2, 0.02);
    }
}

TEST(Removal, BodiesComeBack) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    for (int i = 0; i < 20; ++i) {
        w.add_mesh(table(), 5, at(0.1 * i, 0, 0.41));
        w.steps(7);
        if (i % 3 != 0) w.remove(*w.bodies[1 + static_cast<std::size_t>(i) % (w.bodies.size() - 1)]);
    }
    for (const auto& body : w.bodies) EXPECT_GT(double(body->getWorldTransform().getOrigin().z()), -0.6);
}

TEST(Removal, PinnedBodiesKeepTheirIds) {
    TestWorld w;
    btRigidBody& ground = w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 3));
    EXPECT_EQ(w.dispatcher.add_body(body), BodyId{0});
    EXPECT_EQ(w.dispatcher.add_body(ground), BodyId{1});
    w.steps(120);
    ASSERT_FALSE(w.dispatcher.scene().contacts().empty());
    for (const Contact& c : w.dispatcher.scene().contacts()) {
        EXPECT_EQ(c.body_a, BodyId{0});
        EXPECT_EQ(c.body_b, BodyId{1});
        EXPECT_GT(c.normal.z, -1.01f);
        EXPECT_LT(c.normal.z, -0.99f); // from the table to the ground
    }
    w.world.removeRigidBody(&body);
    EXPECT_EQ(w.dispatcher.scene().body_count(), 2u);
    w.dispatcher.remove_body(body);
    w.dispatcher.remove_body(ground);
    EXPECT_EQ(w.dispatcher.scene().body_count(), 0u);
    const btSphereShape ball(1);
    btCollisionObject sphere;
    sphere.setCollisionShape(const_cast<btSphereShape*>(&ball));
    EXPECT_THROW(w.dispatcher.add_body(sphere), InputError);
}

TEST(Removal, ShapeReplacedWhileTouching) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.4));
    w.steps(30);
    EXPECT_EQ(w.dispatcher.stats().pairs, 1u);
    body.setCollisionShape(
        &w.keep(std::make_unique<btBoxShape>(btVector3(btScalar(0.4), btScalar(0.4), btScalar(0.4)))));
    w.steps(60);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 1u);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.01);
    body.setCollisionShape(&w.keep(std::make_unique<btSphereShape>(btScalar(0.4))));
    w.steps(60);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 0u);
    EXPECT_EQ(w.dispatcher.stats().round_pairs, 1u);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.01);
    body.setCollisionShape(&w.keep(std::make_unique<btEmptyShape>()));
    w.steps(1);
    EXPECT_EQ(w.dispatcher.stats().pairs, 0u);
    EXPECT_EQ(w.touching(), 0);
    body.setCollisionShape(&w.keep(std::make_unique<bullet::MeshShape>(torus())));
    w.steps(120);
    EXPECT_EQ(w.dispatcher.stats().pairs, 1u);
    btVector3 low, high;
    body.getCollisionShape()->getAabb(body.getWorldTransform(), low, high);
    EXPECT_NEAR(double(low.z()), 0, 0.03);
}

TEST(Removal, ChildrenAddedAndRemovedWhileTouching) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    auto made = std::make_unique<btCompoundShape>();
    btCompoundShape& compound = *made;
    auto& mesh = w.keep(std::make_unique<bullet::MeshShape>(table()));
    auto& ball = w.keep(std::make_unique<btSphereShape>(btScalar(0.2)));
    compound.addChildShape(at(-0.6, 0, 0), &mesh);
    compound.addChildShape(at(0.6, 0, 0), &mesh);
    compound.addChildShape(at(0, 0, -0.2), &ball);
    const btRigidBody& body = w.add(std::move(made), 10, at(0, 0, 0.42));
    w.steps(60);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 2u);
    EXPECT_EQ(w.dispatcher.scene().body_count(), 3u);
    compound.removeChildShapeByIndex(0);
    w.steps(1);
    EXPECT_EQ(w.dispatcher.stats().mesh_pairs, 1u);
    EXPECT_EQ(w.dispatcher.scene().body_count(), 2u);
    compound.addChildShape(at(-0.6, 0, 0), &mesh);
    w.steps(120);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.03);
}

TEST(Removal, MeshChangedInPlaceIsRefreshed) {
    const float h = 2;
    std::vector<btVector3> vertices{{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
    const std::vector<int> indices{0, 1, 2, 0, 2, 3};
    btTriangleIndexVertexArray mesh(2, const_cast<int*>(indices.data()), 3 * int(sizeof(int)), 4, &vertices[0][0],
                                    int(sizeof(btVector3)));
    TestWorld w;
    auto shape = std::make_unique<btBvhTriangleMeshShape>(&mesh, false, btVector3(-9, -9, -9), btVector3(9, 9, 9));
    btBvhTriangleMeshShape& sheet = *shape;
    btRigidBody& ground = w.add(std::move(shape), 0, at(0, 0, 0));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0.1, 0, 0.41));
    w.steps(60);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.02);
    for (btVector3& v : vertices) v.setZ(btScalar(0.05));
    sheet.refitTree(btVector3(-9, -9, -9), btVector3(9, 9, 9));
    w.world.updateSingleAabb(&ground);
    w.dispatcher.refresh(ground);
    w.steps(120);
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.45, 0.02);
}

TEST(Removal, OnlyTheBadChildOfACompoundIsLeftOut) {
    TestWorld w;
    btTriangleMesh nothing;
    const btVector3 low(-1, -1, -1), high(1, 1, 1);
    auto& good = w.keep(std::make_unique<bullet::MeshShape>(table()));
    auto& bad = w.keep(std::make_unique<btBvhTriangleMeshShape>(&nothing, false, low, high, false));
    auto made = std::make_unique<btCompoundShape>();
    btCompoundShape& compound = *made;
    compound.addChildShape(at(0, 0, 0), &good);
    compound.addChildShape(at(1, 0, 0), &bad);
    const btRigidBody& body = w.add(std::move(made), 0, at(0, 0, 0));
    for (int i = 0; i < 3; ++i) {
        EXPECT_THROW(w.dispatcher.add_body(body), InputError);
        EXPECT_EQ(w.dispatcher.scene().body_count(), 0u);
    }
    // Nor does what it meets.
    w.add_mesh(table(), 1, at(0, 0, 0.79));
    w.dispatcher.on_fault({});
    for (int i = 0; i < 3; ++i) {
        w.world.performDiscreteCollisionDetection();
        EXPECT_EQ(w.dispatcher.stats().left_out, std::vector<const btCollisionObject*>{&body});
        EXPECT_EQ(w.dispatcher.scene().body_count(), 2u); // all but the bad child
        EXPECT_GT(w.touching(), 0);
    }
    compound.removeChildShape(&bad);
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.dispatcher.scene().body_count(), 2u);
    EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
    EXPECT_GT(w.touching(), 0);
}

} // namespace
} // namespace raycontact::test
