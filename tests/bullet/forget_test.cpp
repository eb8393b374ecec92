// SPDX-License-Identifier: Apache-2.0
// A saved state of a world that is loaded: nothing of the steps in between shows.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>

#include <gtest/gtest.h>

#include <cstring>

namespace raycontact::test {
namespace {

/// What a program saves of a body.
struct Saved {
    btTransform pose, interpolated;
    btVector3 velocity, spin;
    int state;
    btScalar quiet;
};

std::vector<Saved> save(const TestWorld& w) {
    std::vector<Saved> all;
    for (const auto& b : w.bodies)
        all.push_back({b->getWorldTransform(), b->getInterpolationWorldTransform(), b->getLinearVelocity(),
                       b->getAngularVelocity(), b->getActivationState(), b->getDeactivationTime()});
    return all;
}

void load(TestWorld& w, const std::vector<Saved>& saved) {
    for (std::size_t i = 0; i < saved.size(); ++i) {
        btRigidBody& b = *w.bodies[i];
        b.setCenterOfMassTransform(saved[i].pose); // and the inertia there
        b.setInterpolationWorldTransform(saved[i].interpolated);
        b.setLinearVelocity(saved[i].velocity);
        b.setAngularVelocity(saved[i].spin);
        b.setInterpolationLinearVelocity(saved[i].velocity);
        b.setInterpolationAngularVelocity(saved[i].spin);
        b.clearForces();
        b.forceActivationState(saved[i].state);
        b.setDeactivationTime(saved[i].quiet);
        w.world.updateSingleAabb(&b);
    }
}

/// A heap, and a plate that swings into it. mixed: half of it are Bullet's shapes, else one of them. added: the
/// dispatcher knows the meshes from the start.
std::unique_ptr<TestWorld> heap(bool mixed, bool added) {
    auto w = std::make_unique<TestWorld>();
    w->add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    btRigidBody& plate = w->add_mesh(Shape::make(box_mesh(0.2, 1, 0.4)), 0, at(-2, 0, 0.3));
    plate.setCollisionFlags(plate.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    plate.setActivationState(DISABLE_DEACTIVATION);
    for (int i = 0; i < 14; ++i) {
        btTransform pose = at(0.35 * (i % 3) - 0.4, 0.4 * (i / 3 % 2), 0.5 + 0.35 * i);
        pose.setRotation(btQuaternion(btVector3(1, 2, btScalar(i)).normalized(), btScalar(i)));
        if (mixed ? i % 4 == 1 : i == 5)
            w->add(std::make_unique<btSphereShape>(btScalar(0.2)), 2, pose);
        else if (mixed && i % 4 == 2)
            w->add(std::make_unique<btCapsuleShape>(btScalar(0.1), btScalar(0.4)), 2, pose);
        else if (mixed && i % 4 == 3)
            w->add(std::make_unique<btBoxShape>(btVector3(btScalar(0.2), btScalar(0.1), btScalar(0.3))), 2, pose);
        else
            w->add_mesh(i % 8 ? table() : torus(), 3, pose);
    }
    bullet::recommend(w->world);
    if (added)
        for (const auto& b : w->bodies)
            if (b->getCollisionShape()->isConcave()) w->dispatcher.add_body(*b);
    return w;
}

/// As Bullet's broad phase needs it: its boxes and numbers, too, are those of a new one.
void add_again(TestWorld& w) {
    for (const auto& b : w.bodies) w.world.removeRigidBody(b.get());
    w.broadphase.resetPool(&w.dispatcher);
    for (const auto& b : w.bodies) w.world.addRigidBody(b.get());
}

void run(TestWorld& w, int from, int to) {
    for (int i = from; i < to; ++i) {
        btTransform pose = at(-2 + 0.03 * i, 0, 0.3);
        w.bodies[1]->setWorldTransform(pose);
        w.bodies[1]->saveKinematicState(btScalar(1.0 / 60));
        w.steps(1);
    }
}

bool same(const std::vector<Saved>& a, const std::vector<Saved>& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int k = 0; k < 4; ++k) {
            const btVector3 &one = k < 3 ? a[i].pose.getBasis()[k] : a[i].pose.getOrigin(),
                            &two = k < 3 ? b[i].pose.getBasis()[k] : b[i].pose.getOrigin();
            for (int c = 0; c < 3; ++c)
                if (std::memcmp(&one[c], &two[c], sizeof(btScalar)) != 0) return false;
        }
    return true;
}

// Bullet finds the pairs in an order of their history, which a setting takes out: slots go by add_body(). And it keeps
// pairs whose boxes have parted, which a fresh world has not: they join islands, so all is solved as one.
TEST(Forget, MeshesRepeatAsInAFreshWorld) {
    const auto w = heap(false, true), fresh = heap(false, true);
    for (TestWorld* one : {w.get(), fresh.get()}) {
        one->world.getDispatchInfo().m_deterministicOverlappingPairs = true;
        one->world.getSimulationIslandManager()->setSplitIslands(false);
    }
    run(*w, 0, 70);
    const std::vector<Saved> saved = save(*w);
    run(*w, 70, 130);
    const std::vector<Saved> went_on = save(*w);
    load(*w, saved);
    w->dispatcher.forget(w->world);
    run(*w, 70, 130);
    load(*fresh, saved);
    run(*fresh, 70, 130);
    EXPECT_TRUE(same(save(*w), save(*fresh)));
    EXPECT_FALSE(same(save(*w), went_on)) << "else nothing is shown";
}

// Empty manifolds of Bullet's own pairs are in the solver's order, too.
TEST(Forget, AnyWorldThatIsAddedAgainRepeats) {
    const auto w = heap(true, false), fresh = heap(true, false);
    run(*w, 0, 70);
    const std::vector<Saved> saved = save(*w);
    run(*w, 70, 130);
    for (TestWorld* one : {w.get(), fresh.get()}) {
        load(*one, saved);
        add_again(*one);
        one->dispatcher.forget(one->world);
        run(*one, 70, 130);
    }
    EXPECT_TRUE(same(save(*w), save(*fresh)));
}

TEST(Forget, NothingIsTold) {
    btGhostPairCallback callback; // the world asks it to its end
    btPairCachingGhostObject zone;
    btSphereShape ball(2);
    zone.setCollisionShape(&ball);
    zone.setWorldTransform(at(0, 0, 1));
    const auto w = heap(true, true);
    w->broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(&callback);
    w->world.addCollisionObject(&zone, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
    run(*w, 0, 70);
    w->dispatcher.dispatchAllCollisionPairs(zone.getOverlappingPairCache(), w->world.getDispatchInfo(), &w->dispatcher);
    ASSERT_GT(w->dispatcher.stats().touching, 5u);
    ASSERT_FALSE(w->dispatcher.scene().contacts().empty());
    const std::uint32_t meshes = w->dispatcher.scene().body_count();
    w->dispatcher.forget(w->world);
    EXPECT_EQ(w->dispatcher.getNumManifolds(), 0);
    EXPECT_EQ(w->dispatcher.stats().touching, 0u);
    EXPECT_TRUE(w->dispatcher.begun().empty() && w->dispatcher.ended().empty());
    EXPECT_TRUE(w->dispatcher.scene().contacts().empty() && w->dispatcher.scene().lost_contacts().empty());
    EXPECT_LT(w->dispatcher.scene().body_count(), meshes) << "those that were not added";
    w->steps(1);
    EXPECT_GT(w->dispatcher.begun().size(), 5u);
    EXPECT_TRUE(w->dispatcher.ended().empty());
    EXPECT_EQ(w->dispatcher.scene().body_count(), meshes);
    w->world.removeCollisionObject(&zone);
}

} // namespace
} // namespace raycontact::test
