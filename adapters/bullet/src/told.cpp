// SPDX-License-Identifier: Apache-2.0
#include <told.h>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace raycontact::bullet {

namespace {

// Beside those of patches.cpp; they travel with the point wherever Bullet copies it.
constexpr int flag_turned = 1 << 18, flag_soft = 1 << 19;
constexpr int flag_erp = BT_CONTACT_FLAG_HAS_CONTACT_ERP, flag_cfm = BT_CONTACT_FLAG_HAS_CONTACT_CFM;

/// Bullet passes over stiffness and damping where it is given the two numbers, which lie in the same place.
bool has_spring(const btManifoldPoint& point) {
    constexpr int spring = BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
    return (point.m_contactPointFlags & (flag_erp | flag_cfm | spring)) == spring;
}

/// 1 / CFM of a spring.
btScalar yields_by(const btManifoldPoint& point, btScalar seconds) {
    return btMax(seconds * point.m_combinedContactStiffness1 + point.m_combinedContactDamping1, btScalar(SIMD_EPSILON));
}

/// By how much the way of a body's point until the next step is off from the straight one along its velocity.
btVector3 off_straight(const btCollisionObject& object, const btVector3& point, btScalar seconds) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    const btScalar angle = body ? body->getAngularVelocity().length() * seconds : 0;
    if (!(angle > 0)) return btVector3(0, 0, 0);
    const btVector3 arm = point - body->getCenterOfMassPosition(), turn = seconds * body->getAngularVelocity();
    return quatRotate(btQuaternion(turn / angle, angle), arm) - arm - turn.cross(arm);
}

btVector3 velocity_of(const btCollisionObject& object) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body ? body->getLinearVelocity() : btVector3(0, 0, 0);
}

} // namespace

void combine_materials(btManifoldPoint& p, const btCollisionObject* a, const btCollisionObject* b) {
    p.m_combinedFriction = btManifoldResult::calculateCombinedFriction(a, b);
    p.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(a, b);
    p.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(a, b);
    p.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(a, b);
    const int flags = a->getCollisionFlags() | b->getCollisionFlags();
    if (flags & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING) {
        p.m_combinedContactDamping1 = btManifoldResult::calculateCombinedContactDamping(a, b);
        p.m_combinedContactStiffness1 = btManifoldResult::calculateCombinedContactStiffness(a, b);
        p.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
    }
    if (flags & btCollisionObject::CF_HAS_FRICTION_ANCHOR) p.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
}

void turn_round(btManifoldPoint& point, btScalar depth, btScalar seconds) {
    if (has_spring(point)) {
        point.m_contactCFM = 1 / yields_by(point, seconds);
        point.m_contactPointFlags |= flag_cfm;
    }
    point.m_contactERP = 0;
    point.m_contactPointFlags |= flag_erp | flag_turned;
    point.m_distance1 = -depth;
}

void straighten(btManifoldPoint& point, const btCollisionObject& a, const btCollisionObject& b, btScalar seconds) {
    if ((point.m_contactPointFlags & flag_turned) != 0) return;
    const btVector3 off =
        off_straight(a, point.m_positionWorldOnA, seconds) - off_straight(b, point.m_positionWorldOnB, seconds);
    const btVector3& normal = point.m_normalWorldOnB;
    const btScalar away = off.dot(normal), gap = point.m_distance1;
    // What falls faster is stopped by the point, and turns on otherwise.
    if ((velocity_of(b) - velocity_of(a)).dot(normal) * seconds > btFabs(away)) return;
    point.m_distance1 = gap > 0 ? btMax(btScalar(0), gap + away) : gap + btMax(btScalar(0), away);
}

void keep_soft(btPersistentManifold& manifold, const btContactSolverInfo& solver, btScalar seconds) {
    const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
    constexpr int is_soft = btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING;
    const btScalar threshold = solver.m_splitImpulsePenetrationThreshold, slop = solver.m_linearSlop;
    if (!((a.getCollisionFlags() | b.getCollisionFlags()) & is_soft) || !solver.m_splitImpulse || !(threshold < 0))
        return;
    const btScalar stated = threshold / 2 - slop;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
        btManifoldPoint& point = manifold.getContactPoint(i);
        if (point.m_contactPointFlags & flag_turned) continue;
        if (point.m_contactPointFlags & flag_soft) {
            if (point.getDistance() == stated) continue; // of two that sleep
            take_back(point, &a, &b);                    // Bullet's algorithm has moved it
        }
        const btScalar depth = -point.getDistance();
        if (!has_spring(point) || !(depth > 0) || (slop == 0 && -depth > threshold)) continue;
        const btScalar as_rounded = -(stated + slop), divisor = yields_by(point, seconds);
        const btScalar erp = seconds * point.m_combinedContactStiffness1 / divisor;
        point.m_contactCFM = 1 / divisor;
        point.m_contactERP = erp * depth / as_rounded;
        point.m_contactPointFlags |= flag_erp | flag_cfm | flag_soft;
        point.m_distance1 = stated;
    }
}

void take_back(btManifoldPoint& point, const btCollisionObject* a, const btCollisionObject* b) {
    if (!(point.m_contactPointFlags & (flag_turned | flag_soft))) return;
    point.m_contactPointFlags &= ~(flag_erp | flag_cfm | flag_turned | flag_soft);
    combine_materials(point, a, b);
}

} // namespace raycontact::bullet
