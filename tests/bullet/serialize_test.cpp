// SPDX-License-Identifier: Apache-2.0
// A MeshShape in a .bullet file.
#include "test_world.h"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <LinearMath/btSerializer.h>
#ifdef RAYCONTACT_BULLET_IMPORTER
#include <BulletWorldImporter/btBulletWorldImporter.h>
#endif

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace raycontact::test {
namespace {

TEST(Serialize, AMeshShapeIsWrittenAsAMeshOfBullets) {
    bullet::MeshShape shape(torus());
    shape.setLocalScaling(btVector3(1, 2, 1));
    btDefaultSerializer serializer;
    serializer.startSerialization();
    shape.serializeSingleShape(&serializer);
    serializer.finishSerialization();
    const std::string written(reinterpret_cast<const char*>(serializer.getBufferPointer()),
                              static_cast<std::size_t>(serializer.getCurrentBufferSize()));
    EXPECT_NE(written.find("ARAY"), std::string::npos); // vertices and indices

    std::vector<char> bytes(static_cast<std::size_t>(shape.calculateSerializeBufferSize()));
    btDefaultSerializer another;
    another.startSerialization();
    EXPECT_STREQ(shape.serialize(bytes.data(), &another), "btTriangleMeshShapeData");
    another.finishSerialization(); // frees what was written
    btTriangleMeshShapeData data;
    ASSERT_EQ(bytes.size(), sizeof data);
    std::memcpy(&data, bytes.data(), sizeof data);
    EXPECT_EQ(data.m_collisionShapeData.m_shapeType, TRIANGLE_MESH_SHAPE_PROXYTYPE);
    EXPECT_EQ(data.m_meshInterface.m_scaling.m_floats[1], 2);
    EXPECT_EQ(data.m_meshInterface.m_numMeshParts, 1);
}

#ifdef RAYCONTACT_BULLET_IMPORTER
btVector3 inertia_of(const btRigidBody& body) {
    btVector3 inertia;
    body.getCollisionShape()->calculateLocalInertia(5, inertia);
    return inertia;
}

std::vector<char> file_of(TestWorld& world) {
    btDefaultSerializer serializer;
    world.world.serialize(&serializer);
    const unsigned char* const written = serializer.getBufferPointer();
    return {written, written + serializer.getCurrentBufferSize()};
}

TEST(Serialize, AWorldIsReadBack) {
    TestWorld before;
    before.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    auto scaled = std::make_unique<bullet::MeshShape>(torus());
    scaled->setLocalScaling(btVector3(1, 1, 2));
    before.add_mesh(table(), 5, at(0, 0, 0.5));
    before.add(std::move(scaled), 5, at(2, 0, 1));
    before.steps(120); // they lie still
    std::vector<char> file = file_of(before);

    TestWorld after;
    btBulletWorldImporter importer(&after.world);
    ASSERT_TRUE(importer.loadFileFromMemory(file.data(), static_cast<int>(file.size())));
    ASSERT_EQ(importer.getNumRigidBodies(), 3);
    for (int i = 0; i < 3; ++i) {
        auto* const body = static_cast<btRigidBody*>(importer.getRigidBodyByIndex(i));
        const btCollisionShape& was = *before.bodies[static_cast<std::size_t>(i)]->getCollisionShape();
        const btCollisionShape& is = *body->getCollisionShape();
        EXPECT_EQ(is.getShapeType(), TRIANGLE_MESH_SHAPE_PROXYTYPE);
        btVector3 low, high, low_now, high_now;
        was.getAabb(btTransform::getIdentity(), low, high);
        is.getAabb(btTransform::getIdentity(), low_now, high_now);
        EXPECT_LT(double((low - low_now).length() + (high - high_now).length()), 1e-4) << i;
        if (i == 0) continue;
        // Bullet's importer makes every concave mesh static.
        after.world.removeRigidBody(body);
        body->setMassProps(5, inertia_of(*before.bodies[static_cast<std::size_t>(i)]));
        body->setCollisionFlags(0);
        body->setActivationState(DISABLE_DEACTIVATION);
        after.world.addRigidBody(body);
    }
    after.world.setGravity(before.world.getGravity());
    after.steps(120);
    EXPECT_EQ(after.dispatcher.stats().mesh_pairs, 2u);
    for (int i = 0; i < 3; ++i) {
        const btVector3& was = before.bodies[static_cast<std::size_t>(i)]->getWorldTransform().getOrigin();
        const btVector3& is = importer.getRigidBodyByIndex(i)->getWorldTransform().getOrigin();
        EXPECT_LT(double((was - is).length()), 0.01) << i;
    }
    importer.deleteAllData();
}

// As mesh_shape.h says, and no more.
TEST(Serialize, ABodyThatIsReadBackFalls) {
    TestWorld before;
    before.add(std::make_unique<btBoxShape>(btVector3(5, 5, btScalar(0.5))), 0, at(0, 0, -0.5));
    btRigidBody& was = before.add_mesh(torus(), 5, at(0, 0, 4));
    before.steps(1);
    std::vector<char> file = file_of(before);

    TestWorld after;
    btBulletWorldImporter importer(&after.world);
    ASSERT_TRUE(importer.loadFileFromMemory(file.data(), static_cast<int>(file.size())));
    auto* const body = static_cast<btRigidBody*>(importer.getRigidBodyByIndex(1));
    const btVector3 start = body->getWorldTransform().getOrigin();
    after.steps(30);
    EXPECT_EQ(body->getWorldTransform().getOrigin(), start); // static

    after.world.removeRigidBody(body);
    body->setMassProps(5, inertia_of(was));
    body->updateInertiaTensor();
    body->setCollisionFlags(0);
    after.world.addRigidBody(body);
    body->activate(true);
    after.steps(30);
    EXPECT_NEAR(double(start.z() - body->getWorldTransform().getOrigin().z()), 9.81 * 0.5 * 0.5 / 2, 0.05);
    after.steps(240);
    EXPECT_GT(after.touching(), 0);
    btVector3 low, high;
    body->getCollisionShape()->getAabb(body->getWorldTransform(), low, high);
    EXPECT_NEAR(double(low.z()), 0, 0.05);
    importer.deleteAllData();
}
#endif

} // namespace
} // namespace raycontact::test
