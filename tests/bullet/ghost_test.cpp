// SPDX-License-Identifier: Apache-2.0
// Objects that only watch.
#include "test_world.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <gtest/gtest.h>

namespace raycontact::test {
namespace {

// btCollisionObject and btGhostObject begin as static objects.
TEST(Ghost, InAStaticLevelHasItsContactsAsInBullet) {
    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btCollisionWorld world(&dispatcher, &broadphase, &configuration);
    bullet::MeshShape level(Shape::make(box_mesh(8, 8, 1)));
    btSphereShape ball(1);
    btCollisionObject ground;
    btPairCachingGhostObject zone;
    ground.setCollisionShape(&level);
    zone.setCollisionShape(&ball);
    zone.setCollisionFlags(zone.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
    zone.setWorldTransform(at(0, 0, 1));
    ASSERT_TRUE(ground.isStaticObject() && zone.isStaticObject());
    world.addCollisionObject(&ground);
    world.addCollisionObject(&zone);
    world.performDiscreteCollisionDetection();
    ASSERT_EQ(dispatcher.getNumManifolds(), 1);
    EXPECT_GT(dispatcher.getManifoldByIndexInternal(0)->getNumContacts(), 0);
    world.removeCollisionObject(&zone);
    world.removeCollisionObject(&ground);
}

} // namespace
} // namespace raycontact::test
