// SPDX-License-Identifier: Apache-2.0
#include <pair.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace raycontact::bullet {

namespace {

// As Bullet's solver asks, with its own m_restitutionVelocityThreshold; and what will touch before the next step.
bool bounces(const btManifoldPoint& point, const PairState& state, btScalar seconds) {
    if (!(point.m_combinedRestitution > 0)) return false;
    const btVector3 speed =
        velocity_at(*state.object0, point.m_positionWorldOnA) - velocity_at(*state.object1, point.m_positionWorldOnB);
    const btScalar approach = -speed.dot(point.m_normalWorldOnB);
    return approach > btScalar(0.2) && approach * seconds >= point.getDistance();
}

// Bullet takes gap and slop, by the length of the step, off the speed that restitution gives back; nothing of a depth
// that no slop reaches. The depth itself must not be undone.
void turn_round(btManifoldPoint& point, btScalar depth, btScalar seconds) {
    constexpr int both = BT_CONTACT_FLAG_HAS_CONTACT_ERP | BT_CONTACT_FLAG_HAS_CONTACT_CFM;
    if ((point.m_contactPointFlags & (both | BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING))
        == BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING) {
        // Bullet would pass over stiffness and damping now; and they lie where the two numbers go.
        point.m_contactCFM = 1
                             / btMax(seconds * point.m_combinedContactStiffness1 + point.m_combinedContactDamping1,
                                     btScalar(SIMD_EPSILON));
        point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_CFM;
    }
    point.m_contactERP = 0;
    point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_ERP;
    point.m_distance1 = -depth;
}

} // namespace

btVector3 velocity_at(const btCollisionObject& object, const btVector3& point) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body ? body->getVelocityInLocalPoint(point - body->getCenterOfMassPosition()) : btVector3(0, 0, 0);
}

PairState::PairState(btCollisionDispatcher& dispatcher, Touches& touches, const btCollisionObject& a,
                     const btCollisionObject& b, std::shared_ptr<Object> of_a, std::shared_ptr<Object> of_b)
    : object0(&a), object1(&b), record0(std::move(of_a)), record1(std::move(of_b)), patches(dispatcher, &a, &b),
      dispatcher_(dispatcher), touches_(touches) {}

void PairState::clear() {
    children_.clear();
    patches.clear();
    touches_.end(*this);
}

void PairState::check_versions() {
    if (record0->version == version0_ && record1->version == version1_) return;
    children_.clear();
    if (version0_ != 0) patches.clear();
    version0_ = record0->version;
    version1_ = record1->version;
}

void PairState::run_child(const LeafPair& pair, const btDispatcherInfo& info) {
    const Leaf &a = pair.leaf0, &b = pair.leaf1;
    const btTransform pose0 = object0->getWorldTransform() * a.local;
    const btTransform pose1 = object1->getWorldTransform() * b.local;
    auto found = std::find_if(children_.begin(), children_.end(),
                              [&](const ChildPair& c) { return c.leaf0 == pair.child0 && c.leaf1 == pair.child1; });
    btVector3 low0, high0, low1, high1;
    a.shape->getAabb(pose0, low0, high0);
    b.shape->getAabb(pose1, low1, high1);
    const btVector3 reach(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
    if (!TestAabbAgainstAabb2(low0 - reach, high0 + reach, low1, high1)) {
        if (found != children_.end()) children_.erase(found);
        return;
    }
    const btCollisionObjectWrapper whole0(nullptr, object0->getCollisionShape(), object0, object0->getWorldTransform(),
                                          -1, -1);
    const btCollisionObjectWrapper whole1(nullptr, object1->getCollisionShape(), object1, object1->getWorldTransform(),
                                          -1, -1);
    const btCollisionObjectWrapper child0(&whole0, a.shape, object0, pose0, -1, pair.child0);
    const btCollisionObjectWrapper child1(&whole1, b.shape, object1, pose1, -1, pair.child1);
    const bool is_child0 = a.shape != object0->getCollisionShape(), is_child1 = b.shape != object1->getCollisionShape();
    const btCollisionObjectWrapper &wrap0 = is_child0 ? child0 : whole0, &wrap1 = is_child1 ? child1 : whole1;
    if (found == children_.end()) {
        children_.push_back(
            {pair.child0, pair.child1, bullets_algorithm(dispatcher_, wrap0, wrap1, BT_CONTACT_POINT_ALGORITHMS)});
        found = children_.end() - 1;
    }
    btManifoldResult result(&wrap0, &wrap1);
    result.setShapeIdentifiersA(-1, is_child0 ? pair.child0 : -1);
    result.setShapeIdentifiersB(-1, is_child1 ? pair.child1 : -1);
    found->algorithm->processCollision(&wrap0, &wrap1, info, &result);
}

void PairState::all_manifolds(btManifoldArray& out) const {
    for (btPersistentManifold* m : patches.manifolds()) out.push_back(m);
    for (const ChildPair& child : children_) child.algorithm->getAllContactManifolds(out);
}

void PairState::name_places() {
    for (Candidate& c : candidates) bullet::name_places(c, leaf0(c.key), leaf1(c.key));
}

void PairState::turn_round_what_bounces(btScalar seconds) const {
    for (btPersistentManifold* manifold : patches.manifolds()) {
        for (int i = 0; i < manifold->getNumContacts(); ++i) {
            btManifoldPoint& point = manifold->getContactPoint(i);
            if (point.getDistance() < 0 || !bounces(point, *this, seconds)) continue;
            const PointKey key = CollisionDispatcher::key(point);
            const bool found =
                std::ranges::any_of(candidates, [&](const Candidate& c) { return c.speculative && c.key == key; });
            if (!found) continue; // held, or touching: as without speculative contacts
            turn_round(point, btMin(diagonal(leaf0(key)), diagonal(leaf1(key))), seconds);
        }
    }
}

} // namespace raycontact::bullet
