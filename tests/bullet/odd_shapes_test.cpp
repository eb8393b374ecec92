// SPDX-License-Identifier: Apache-2.0
// Shapes with numbers that are none, beyond all bounds, negative or zero: no hang, no crash, and the object is named.
#include "test_world.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::test {
namespace {

constexpr btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
constexpr btScalar inf = std::numeric_limits<btScalar>::infinity();
constexpr btScalar huge = btScalar(3e38);

struct Odd {
    std::string name;
    std::function<std::unique_ptr<btCollisionShape>()> make;
};

std::unique_ptr<btCollisionShape> hull(const btVector3& last, const btVector3& scaling = btVector3(1, 1, 1)) {
    auto shape = std::make_unique<btConvexHullShape>();
    for (int i = 0; i < 7; ++i) shape->addPoint(btVector3(btScalar(i & 1), btScalar(i >> 1 & 1), btScalar(i >> 2)));
    shape->addPoint(last);
    shape->setLocalScaling(scaling);
    return shape;
}

std::unique_ptr<btCollisionShape> balls(const btVector3& centre, btScalar radius, int count,
                                        const btVector3& scaling = btVector3(1, 1, 1)) {
    const btVector3 centres[] = {centre, btVector3(0, 0, 0), btVector3(1, 0, 0)};
    const btScalar radii[] = {radius, btScalar(0.5), btScalar(0.3)};
    auto shape = std::make_unique<btMultiSphereShape>(centres, radii, count);
    shape->setLocalScaling(scaling);
    return shape;
}

template <class S, class... Sizes>
Odd plain(const std::string& name, Sizes... sizes) {
    return {name, [=] { return std::make_unique<S>(sizes...); }};
}

/// Of a plane its constructor would mend or spoil the normal.
struct Plane : btStaticPlaneShape {
    Plane(const btVector3& normal, btScalar constant) : btStaticPlaneShape(btVector3(0, 0, 1), constant) {
        m_planeNormal = normal;
    }
};

std::vector<Odd> odd_shapes() {
    std::vector<Odd> all;
    for (const btScalar x : {nan, inf, -inf, huge}) {
        const std::string of = " " + std::to_string(x);
        for (const btVector3& p : {btVector3(x, 1, 1), btVector3(1, x, 1), btVector3(1, 1, x), btVector3(x, x, x)})
            all.push_back({"hull" + of, [p] { return hull(p); }});
        all.push_back({"scaled hull" + of, [x] { return hull(btVector3(1, 1, 1), btVector3(1, x, 1)); }});
        for (const int count : {1, 2, 3}) {
            all.push_back({"balls at" + of, [=] { return balls(btVector3(0, x, 0), btScalar(0.5), count); }});
            all.push_back({"balls of" + of, [=] { return balls(btVector3(0, 0, 1), x, count); }});
        }
        all.push_back({"scaled balls" + of, [x] { return balls(btVector3(0, 0, 1), 1, 3, btVector3(1, 1, x)); }});
        all.push_back(plain<btBoxShape>("box" + of, btVector3(1, x, 1)));
        all.push_back(plain<btCylinderShape>("cylinder radius" + of, btVector3(x, 1, x)));
        all.push_back(plain<btCylinderShapeZ>("cylinder height" + of, btVector3(1, 1, x)));
        all.push_back(plain<btConeShape>("cone radius" + of, x, btScalar(1)));
        all.push_back(plain<btConeShapeX>("cone height" + of, btScalar(1), x));
        all.push_back(plain<btSphereShape>("ball" + of, x));
        all.push_back(plain<btCapsuleShape>("capsule radius" + of, x, btScalar(1)));
        all.push_back(plain<btCapsuleShapeZ>("capsule height" + of, btScalar(1), x));
        if (x != huge) {
            all.push_back(plain<Plane>("plane normal" + of, btVector3(0, x, 1), btScalar(0)));
            all.push_back(plain<Plane>("plane constant" + of, btVector3(0, 0, 1), x));
        }
    }
    all.push_back(plain<Plane>("no normal", btVector3(0, 0, 0), btScalar(0)));
    all.push_back(plain<btBoxShape>("box without a face", btVector3(0, 0, 1)));
    all.push_back(plain<btBoxShape>("box without a size", btVector3(0, 0, 0)));
    all.push_back(plain<btCylinderShape>("cylinder without a radius", btVector3(0, 1, 0)));
    all.push_back(plain<btConeShape>("cone without a radius", btScalar(0), btScalar(1)));
    all.push_back(plain<btSphereShape>("ball inside out", btScalar(-1)));
    all.push_back(plain<btCapsuleShape>("capsule inside out", btScalar(-1), btScalar(1)));
    all.push_back(plain<btCapsuleShape>("capsule upside down", btScalar(1), btScalar(-1)));
    all.push_back({"balls inside out", [] { return balls(btVector3(0, 0, 1), -1, 3); }});
    return all;
}

/// The faults that were told.
struct Told {
    explicit Told(TestWorld& world) {
        world.dispatcher.on_fault([this](const bullet::Fault& fault) { faults.push_back(fault); });
    }
    std::vector<bullet::Fault> faults;
};

// Inside a compound, whose box stays finite: Bullet pairs no object with a box that is not.
TEST(OddShapes, TheChildIsLeftOutAndNamedTheOtherStays) {
    int met = 0;
    for (const Odd& odd : odd_shapes()) {
        SCOPED_TRACE(odd.name);
        TestWorld w;
        Told told(w);
        btCollisionShape& bad = w.keep(odd.make());
        auto compound = std::make_unique<btCompoundShape>(false);
        compound->addChildShape(at(0, 0, 0), &w.keep(std::make_unique<bullet::MeshShape>(table())));
        compound->addChildShape(at(0, 0, 0), &bad);
        w.add(std::move(compound), 0, at(0, 0, 0));
        const btCollisionObject& object = *w.bodies[0];
        w.add_mesh(table(), 1, at(0, 0, 0.79));
        w.world.performDiscreteCollisionDetection();
        if (w.dispatcher.stats().pairs == 0) continue; // Bullet's box of the whole is not finite; the other test has it
        ++met;
        w.world.performDiscreteCollisionDetection();
        EXPECT_EQ(w.dispatcher.stats().left_out, std::vector<const btCollisionObject*>{&object});
        ASSERT_EQ(told.faults.size(), 1u);
        EXPECT_EQ(told.faults[0].object, &object);
        EXPECT_EQ(told.faults[0].child, 1);
        EXPECT_GT(w.dispatcher.stats().points_matched, 0u) << "the other child's points must not be made anew";
        EXPECT_EQ(w.dispatcher.stats().points_matched, w.dispatcher.stats().points);
    }
    EXPECT_GT(met, 50);
}

TEST(OddShapes, QueriesAndAddBodyNameThem) {
    for (const Odd& odd : odd_shapes()) {
        SCOPED_TRACE(odd.name);
        TestWorld w;
        Told told(w);
        w.add_mesh(table(), 0, at(0, 0, 0));
        const std::unique_ptr<btCollisionShape> shape = odd.make();
        btCollisionObject object;
        object.setCollisionShape(shape.get());
        try {
            w.dispatcher.add_body(object);
            ADD_FAILURE() << "it was added";
        } catch (const bullet::ObjectError& error) {
            EXPECT_EQ(error.fault().object, &object);
            EXPECT_NE(std::string(error.what()).find(shape->getName()), std::string::npos);
        }
        btCompoundShape compound(false);
        compound.addChildShape(at(0, 0, 0), shape.get());
        object.setCollisionShape(&compound);
        Count count;
        w.world.contactPairTest(&object, w.bodies[0].get(), count);
        EXPECT_EQ(count.points, 0);
        EXPECT_LE(told.faults.size(), 1u); // none where the boxes do not meet
        for (const bullet::Fault& fault : told.faults) EXPECT_EQ(fault.object, &object);
    }
}

// These are odd, but have a surface.
TEST(OddShapes, WhatIsFlatIsTaken) {
    const std::vector<Odd> all{
        plain<btBoxShape>("flat box", btVector3(1, 1, 0)),
        plain<btCylinderShapeZ>("disc", btVector3(1, 1, 0)),
        plain<btSphereShape>("point", btScalar(0)),
        plain<btCapsuleShapeZ>("line", btScalar(0), btScalar(1)),
    };
    for (const Odd& odd : all) {
        SCOPED_TRACE(odd.name);
        TestWorld w;
        Told told(w);
        w.add_mesh(Shape::make(box_mesh(4, 4, 2)), 0, at(0.1, 0.2, -0.95));
        w.add(odd.make(), 1, at(0, 0, 0));
        w.world.performDiscreteCollisionDetection();
        EXPECT_TRUE(told.faults.empty());
        EXPECT_GT(w.dispatcher.stats().points, 0u);
    }
}

TEST(OddShapes, FieldsAndScaledMeshesAreNamed) {
    btTriangleMesh triangles;
    triangles.addTriangle(btVector3(-1, -1, 0), btVector3(1, -1, 0), btVector3(0, 1, 0));
    btBvhTriangleMeshShape plain_mesh(&triangles, true);
    for (const btScalar x : {nan, inf, btScalar(0)}) {
        SCOPED_TRACE(x);
        std::vector<btScalar> heights(9, btScalar(0.5));
        if (x != btScalar(0)) heights[4] = x;
        btHeightfieldTerrainShape field(3, 3, heights.data(), btScalar(0), btScalar(1), 2, false);
        btHeightfieldTerrainShape scaled_field(3, 3, heights.data(), btScalar(0), btScalar(1), 2, false);
        scaled_field.setLocalScaling(btVector3(1, x, 1));
        btScaledBvhTriangleMeshShape scaled(&plain_mesh, btVector3(1, x, 1));
        for (btCollisionShape* shape :
             {static_cast<btCollisionShape*>(&field), static_cast<btCollisionShape*>(&scaled_field),
              static_cast<btCollisionShape*>(&scaled)}) {
            if (shape == &field && x == btScalar(0)) continue;
            TestWorld w;
            Told told(w);
            w.add_mesh(table(), 1, at(0, 0, 0));
            btCollisionObject object;
            object.setCollisionShape(shape);
            EXPECT_THROW(w.dispatcher.add_body(object), bullet::ObjectError) << shape->getName();
            w.world.addCollisionObject(&object);
            w.world.performDiscreteCollisionDetection();
            Count count;
            w.world.contactTest(&object, count);
            EXPECT_EQ(count.points, 0) << shape->getName();
            w.world.removeCollisionObject(&object);
        }
    }
}

} // namespace
} // namespace raycontact::test
