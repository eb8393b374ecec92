// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace raycontact::test {

/// An axis-aligned box of 12 triangles, outward, centred at the origin. Metres.
Mesh box_mesh(double x, double y, double z);
/// A concave table: a slab of 1 x 1 x 0.2 on four legs, one connected closed surface, 0.8 high, centred in its box.
Mesh table_mesh();
std::shared_ptr<const Shape> table();
std::shared_ptr<const Shape> torus();

inline btTransform at(double x, double y, double z) {
    return btTransform(btQuaternion::getIdentity(), btVector3(btScalar(x), btScalar(y), btScalar(z)));
}

inline btMatrix3x3 diagonal(double x, double y, double z) {
    return btMatrix3x3(btScalar(x), 0, 0, 0, btScalar(y), 0, 0, 0, btScalar(z));
}

/// A Bullet world with our dispatcher in place of Bullet's: z up, metres, 60 steps a second.
struct TestWorld {
    explicit TestWorld(const Settings& settings = {}, const bullet::ManifoldSettings& manifolds = {},
                       bullet::ConvexShapes convex = bullet::ConvexShapes::by_mesh);
    ~TestWorld();

    /// Keeps the shape; mass 0 is static.
    btRigidBody& add(std::unique_ptr<btCollisionShape> shape, double mass, const btTransform& pose);
    btRigidBody& add_mesh(std::shared_ptr<const Shape> shape, double mass, const btTransform& pose) {
        return add(std::make_unique<bullet::MeshShape>(std::move(shape)), mass, pose);
    }
    template <class S>
    S& keep(std::unique_ptr<S> shape) {
        S& kept = *shape;
        shapes.push_back(std::move(shape));
        return kept;
    }
    void remove(btRigidBody& body);
    void steps(int count);
    /// Manifolds with at least one point.
    int touching() const;

    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher;
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
};

/// Counts the points that a query finds.
struct Count : btCollisionWorld::ContactResultCallback {
    int points = 0;
    btScalar addSingleResult(btManifoldPoint&, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        ++points;
        return 0;
    }
};

} // namespace raycontact::test
