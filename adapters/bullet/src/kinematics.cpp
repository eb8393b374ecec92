// SPDX-License-Identifier: Apache-2.0
#include <kinematics.h>

#include <convert.h>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

namespace raycontact::bullet {

namespace {

/// Beyond this squared diagonal Bullet takes a box for an error.
constexpr btScalar most_diagonal2 = btScalar(1e12);

/// A tree that collides at once has the pairs already. A second look in one step would also count its moving leaves as
/// resting ones.
bool finds_pairs_at_once(const btBroadphaseInterface& broad_phase) {
    const auto* tree = dynamic_cast<const btDbvtBroadphase*>(&broad_phase);
    return tree != nullptr && !tree->m_deferedcollide;
}

} // namespace

std::optional<btTransform> Kinematics::next_of(const btCollisionObject& object) {
    if (!(seconds_ > 0) || !object.isKinematicObject()) return std::nullopt;
    const btRigidBody* body = btRigidBody::upcast(&object);
    const btBroadphaseProxy* proxy = object.getBroadphaseHandle();
    if (body == nullptr || proxy == nullptr) return std::nullopt;
    const btVector3 &velocity = body->getLinearVelocity(), &spin = body->getAngularVelocity();
    if (velocity.isZero() && spin.isZero()) return std::nullopt;

    const btTransform& pose = body->getWorldTransform();
    const auto [found, is_first] = motions_.try_emplace(body);
    Motion& motion = found->second;
    if (is_first || motion.dispatch != dispatch_) {
        const bool is_known = !is_first && motion.dispatch + 1 == dispatch_ && motion.stay == proxy->getUid();
        // Between the substeps of one step nothing moves it: what was said of its motion holds.
        const bool is_substep = is_known && motion.pose == pose;
        if (!is_substep) {
            const btScalar size = (proxy->m_aabbMax - proxy->m_aabbMin).length();
            const auto way = [&](const btVector3& shift, const btVector3& turn) {
                return seconds_ * (shift.length() + btScalar(0.5) * size * turn.length());
            };
            const btScalar now = way(velocity, spin);
            const bool goes_on = is_known && way(velocity - motion.velocity, spin - motion.spin) <= btScalar(0.5) * now;
            motion.is_believed = now <= size || goes_on;
        }
        motion = {pose, velocity, spin, dispatch_, proxy->getUid(), motion.is_believed};
    }
    if (!motion.is_believed) return std::nullopt;
    btTransform next;
    btTransformUtil::integrateTransform(pose, velocity, spin, seconds_, next);
    return next;
}

void Kinematics::sweep(btCollisionWorld& world, btDispatcher* dispatcher) {
    if (!(seconds_ > 0)) return;
    btBroadphaseInterface& broad_phase = *world.getBroadphase();
    const btCollisionObjectArray& objects = world.getCollisionObjectArray();
    bool any = false;
    for (int i = 0; i < objects.size(); ++i) {
        const btCollisionObject& object = *objects[i];
        if (!object.isKinematicObject() || !object.isActive()) continue;
        const auto next = next_of(object);
        if (!next) continue;
        btBroadphaseProxy* proxy = const_cast<btBroadphaseProxy*>(object.getBroadphaseHandle());
        btVector3 low, high;
        object.getCollisionShape()->getAabb(*next, low, high);
        const btVector3 around(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
        low -= around;
        high += around;
        low.setMin(proxy->m_aabbMin);
        high.setMax(proxy->m_aabbMax);
        if (!((high - low).length2() < most_diagonal2)) continue;
        broad_phase.setAabb(proxy, low, high, dispatcher);
        any = true;
    }
    if (any && !finds_pairs_at_once(broad_phase)) broad_phase.calculateOverlappingPairs(dispatcher);
}

} // namespace raycontact::bullet
