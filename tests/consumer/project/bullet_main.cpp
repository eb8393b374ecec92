// SPDX-License-Identifier: Apache-2.0
// A Bullet world whose dispatcher is RayContact's: a cube of triangles, dropped on a slab that does not move.
#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <btBulletCollisionCommon.h>

#include <cstdio>

int main() {
    raycontact::Mesh cube;
    cube.name = "cube";
    cube.vertices = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                     {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    cube.triangles = {{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                      {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    raycontact::Mesh slab = cube;
    for (auto& vertex : slab.vertices) vertex = {10 * vertex.x, vertex.y, 10 * vertex.z};
    raycontact::bullet::MeshShape shape(raycontact::Shape::make(cube));
    raycontact::bullet::MeshShape ground_shape(raycontact::Shape::make(slab));

    btDefaultCollisionConfiguration configuration;
    raycontact::bullet::CollisionDispatcher dispatcher(&configuration); // in place of btCollisionDispatcher
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);

    btRigidBody ground(0, nullptr, &ground_shape);
    btVector3 inertia;
    shape.calculateLocalInertia(1, inertia);
    btRigidBody falling(1, nullptr, &shape, inertia);
    falling.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(btScalar(0.1), btScalar(2.2), 0)));
    world.addRigidBody(&ground);
    world.addRigidBody(&falling);
    for (int step = 0; step < 120; ++step) world.stepSimulation(btScalar(1.0 / 60), 0);

    const double height = falling.getWorldTransform().getOrigin().y();
    std::printf("came to rest at a height of %.3f\n", height);
    world.removeRigidBody(&falling);
    world.removeRigidBody(&ground);
    return height > 1.95 && height < 2.01 ? 0 : 1;
}
