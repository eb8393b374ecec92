// SPDX-License-Identifier: Apache-2.0
#include "test_world.h"

#include <convert.h>
#include <raycontact/error.h>

#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace raycontact::test {
namespace {

using bullet::Kind;
using bullet::kind_of;

/// One box as a mesh interface of a part: vertices of type V, indices of type I.
template <class V, class I>
struct Arrays {
    std::vector<V> vertices;
    std::vector<I> indices;
    explicit Arrays(const Mesh& mesh, double shift = 0) {
        for (const Vec3& v : mesh.vertices)
            for (const double c : {v.x + shift, v.y, v.z}) vertices.push_back(V(c));
        for (const auto& t : mesh.triangles)
            for (const std::uint32_t k : t) indices.push_back(I(k));
    }
    btIndexedMesh part(PHY_ScalarType vertex_type, PHY_ScalarType index_type) {
        btIndexedMesh m;
        m.m_numTriangles = int(indices.size() / 3);
        m.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices.data());
        m.m_triangleIndexStride = 3 * int(sizeof(I));
        m.m_numVertices = int(vertices.size() / 3);
        m.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices.data());
        m.m_vertexStride = 3 * int(sizeof(V));
        m.m_indexType = index_type;
        m.m_vertexType = vertex_type;
        return m;
    }
};

TEST(Convert, PartsOfEveryTypeOneAfterAnother) {
    const Mesh box = box_mesh(1, 1, 1);
    Arrays<float, unsigned int> a(box);
    Arrays<double, unsigned short> b(box, 2);
    Arrays<float, unsigned char> c(box, 4);
    btTriangleIndexVertexArray mesh;
    mesh.addIndexedMesh(a.part(PHY_FLOAT, PHY_INTEGER), PHY_INTEGER);
    mesh.addIndexedMesh(b.part(PHY_DOUBLE, PHY_SHORT), PHY_SHORT);
    mesh.addIndexedMesh(c.part(PHY_FLOAT, PHY_UCHAR), PHY_UCHAR);
    btBvhTriangleMeshShape shape(&mesh, true, false);
    ASSERT_EQ(kind_of(shape), Kind::mesh);
    bullet::ShapeCache cache(1);
    const auto converted = cache.get(shape);
    EXPECT_EQ(converted.shape->triangles().size(), 36u);
    EXPECT_EQ(converted.shape->vertices().size(), 24u);
    EXPECT_EQ(converted.shape->report().components, 3u);
    EXPECT_NEAR(converted.shape->report().volume, 3, 1e-5);
    EXPECT_EQ(converted.shape->vertex_index()[23], 23u);
    EXPECT_NEAR(converted.shape->box_max().x, 4.5, 1e-6);
}

TEST(Convert, EqualContentIsOneShape) {
    const Mesh box = box_mesh(1, 1, 1), longer = box_mesh(1, 1, 2);
    Arrays<float, unsigned int> a(box), b(box), c(longer);
    btTriangleIndexVertexArray ma, mb, mc;
    ma.addIndexedMesh(a.part(PHY_FLOAT, PHY_INTEGER));
    mb.addIndexedMesh(b.part(PHY_FLOAT, PHY_INTEGER));
    mc.addIndexedMesh(c.part(PHY_FLOAT, PHY_INTEGER));
    btBvhTriangleMeshShape sa(&ma, true), sb(&mb, true), sc(&mc, true);
    bullet::ShapeCache cache(1);
    EXPECT_EQ(cache.get(sa).shape, cache.get(sb).shape);
    EXPECT_NE(cache.get(sa).shape, cache.get(sc).shape);
    // Nobody holds them: gone after a while, made anew when asked for.
    const std::weak_ptr<const Shape> watched = cache.get(sa).shape;
    for (int i = 0; i < 2000; ++i) cache.sweep();
    EXPECT_TRUE(watched.expired());
    EXPECT_EQ(cache.get(sa).shape->triangles().size(), 12u);
}

TEST(Convert, ScalingAndMirroring) {
    const Mesh box = box_mesh(1, 1, 1);
    Arrays<float, unsigned int> a(box);
    btTriangleIndexVertexArray mesh;
    mesh.addIndexedMesh(a.part(PHY_FLOAT, PHY_INTEGER));
    btBvhTriangleMeshShape base(&mesh, true);
    const btScaledBvhTriangleMeshShape scaled(&base, btVector3(2, 3, -1));
    bullet::ShapeCache cache(1);
    const auto converted = cache.get(scaled);
    EXPECT_NEAR(converted.shape->report().volume, 6, 1e-5); // positive: windings turned with the mirror
    EXPECT_NEAR(converted.shape->box_max().y, 1.5, 1e-6);

    btGImpactMeshShape gimpact(&mesh);
    gimpact.setLocalScaling(btVector3(1, 2, 1));
    gimpact.updateBound();
    EXPECT_EQ(kind_of(gimpact), Kind::mesh);
    EXPECT_NEAR(cache.get(gimpact).shape->report().volume, 2, 1e-5);
    EXPECT_EQ(bullet::scaling_of(gimpact), btVector3(1, 2, 1));
}

TEST(Convert, BadMeshesAreNamed) {
    const Mesh box = box_mesh(1, 1, 1);
    Arrays<float, unsigned int> a(box);
    btTriangleIndexVertexArray mesh;
    mesh.addIndexedMesh(a.part(PHY_FLOAT, PHY_INTEGER));
    btBvhTriangleMeshShape shape(&mesh, true);
    bullet::ShapeCache cache(1);
    a.indices[5] = 77;
    try {
        cache.get(shape);
        FAIL() << "an index out of range was taken";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("77"), std::string::npos) << error.what();
    }
}

TEST(Convert, KindsOfShapes) {
    EXPECT_EQ(kind_of(btSphereShape(1)), Kind::round);
    EXPECT_EQ(kind_of(btCapsuleShape(1, 1)), Kind::round);
    EXPECT_EQ(kind_of(btBoxShape(btVector3(1, 1, 1))), Kind::convex);
    EXPECT_EQ(kind_of(btCylinderShape(btVector3(1, 1, 1))), Kind::convex);
    EXPECT_EQ(kind_of(btConeShape(1, 1)), Kind::convex);
    EXPECT_EQ(kind_of(btBox2dShape(btVector3(1, 1, 1))), Kind::other);
    const btSphereShape ball(1);
    EXPECT_EQ(kind_of(btUniformScalingShape(const_cast<btSphereShape*>(&ball), 2)), Kind::other);
    EXPECT_EQ(kind_of(btStaticPlaneShape(btVector3(0, 0, 1), 0)), Kind::plane);
}

TEST(Convert, ScaledMeshShapeKeepsItsFilesIndices) {
    bullet::MeshShape shape(table());
    shape.setLocalScaling(btVector3(-2, 1, 1));
    EXPECT_NEAR(shape.shape()->report().volume, 2 * table()->report().volume, 1e-4);
    EXPECT_EQ(shape.shape()->vertex_index().size(), table()->vertex_index().size());
    for (const btScalar bad : {btScalar(0), btScalar(NAN), btScalar(1e-9), btScalar(1e12)})
        EXPECT_THROW(shape.setLocalScaling(btVector3(bad, bad, bad)), InputError) << bad;
    EXPECT_EQ(shape.getLocalScaling(), btVector3(-2, 1, 1)) << "what is refused changes nothing";
    EXPECT_THROW(bullet::MeshShape(nullptr), InputError);
    shape.setLocalScaling(btVector3(1, 1, 1));
    EXPECT_EQ(shape.shape(), table());
}

TEST(Convert, AScaleThatChangesForEverKeepsFewMeshes) {
    bullet::ShapeCache cache(1);
    const bullet::Converted original{table(), std::make_shared<bullet::BulletMesh>(table())};
    const bullet::Stretch held{3, 0, 0, 0, 3, 0, 0, 0, 3};
    const bullet::Converted in_use = cache.stretched(original, held);
    std::vector<std::weak_ptr<const Shape>> made;
    for (int i = 0; i < 200; ++i) {
        cache.sweep(); // a dispatch
        const double scale = 1.01 + 0.01 * i;
        made.push_back(cache.stretched(original, {scale, 0, 0, 0, scale, 0, 0, 0, 1}).shape);
    }
    EXPECT_LE(std::ranges::count_if(made, [](const auto& shape) { return !shape.expired(); }), 16);
    const std::uint64_t before = cache.made();
    EXPECT_EQ(cache.stretched(original, held).shape, in_use.shape);
    EXPECT_EQ(cache.made(), before);
}

/// How many shapes the dispatches made while a table fell on a static mesh of Bullet's.
std::uint64_t made_while_running(bool ahead) {
    const Mesh box = box_mesh(6, 6, 1);
    Arrays<float, unsigned int> arrays(box);
    btTriangleIndexVertexArray mesh;
    mesh.addIndexedMesh(arrays.part(PHY_FLOAT, PHY_INTEGER));
    TestWorld w;
    btRigidBody& floor = w.add(std::make_unique<btBvhTriangleMeshShape>(&mesh, true), 0, at(0, 0, -0.5));
    if (ahead) w.dispatcher.add_body(floor);
    w.add_mesh(table(), 5, at(0, 0, 1));
    std::uint64_t made = 0;
    for (int i = 0; i < 60; ++i) {
        w.steps(1);
        made += w.dispatcher.stats().shapes_made;
    }
    EXPECT_GT(w.touching(), 0);
    if (ahead) w.dispatcher.remove_body(floor);
    return made;
}

TEST(Convert, AddBodyMakesTheShapeAhead) {
    EXPECT_EQ(made_while_running(false), 1u);
    EXPECT_EQ(made_while_running(true), 0u);
}

TEST(Convert, AShapeTakesAQuarterOfAKilobyteATriangle) {
    const auto shape = Shape::make(scenes::scene_model("torus", 50000).mesh);
    EXPECT_LT(shape->memory_bytes(), 256 * shape->triangles().size());
}

} // namespace
} // namespace raycontact::test
