// SPDX-License-Identifier: Apache-2.0
#include <pair.h>
#include <told.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace raycontact::bullet {

namespace {

/// As Bullet's solver asks, with its own m_restitutionVelocityThreshold.
constexpr btScalar least_approach = btScalar(0.2);
/// Cosine from which on two normals are of one place.
constexpr btScalar like = btScalar(0.9);

/// Metres a second, along the point's normal.
btScalar approach_at(const btManifoldPoint& point, const PairState& state) {
    const btVector3 speed =
        velocity_at(*state.object0, point.m_positionWorldOnA) - velocity_at(*state.object1, point.m_positionWorldOnB);
    return -speed.dot(point.m_normalWorldOnB);
}

btVector3 acceleration_of(const btCollisionObject& object) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    if (body == nullptr || body->isStaticOrKinematicObject()) return btVector3(0, 0, 0);
    return body->getInvMass() * body->getLinearFactor() * body->getTotalForce();
}

/// Motion along a normal towards a surface, in Bullet's steps: speed is changed, then place by the changed speed. Its
/// energy, per kilogram, is the same in each step of a free fall.
struct Fall {
    btScalar pull, seconds; ///< pull: m/s^2, towards the surface; not negative
    btScalar energy(btScalar gap, btScalar speed) const {
        return speed * speed / 2 + pull * (gap + speed * seconds / 2);
    }
    /// The speed away from the surface that has this energy after a step that begins at a gap; negative: none has.
    btScalar speed_away(btScalar gap, btScalar energy) const {
        const btScalar half = pull * seconds / 2, left = energy - pull * gap;
        return left < 0 ? -1 : btSqrt(half * half + 2 * left) - half;
    }
};

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

void PairState::tell_solver(btScalar seconds) {
    turn_round_what_bounces(seconds);
    for (btPersistentManifold* manifold : patches.manifolds())
        for (int i = 0; i < manifold->getNumContacts(); ++i)
            straighten(manifold->getContactPoint(i), *object0, *object1, seconds);
}

// What is turned round above the surface gives the energy of that height away: it rises as high as from the surface.
// What would not rise to where it is comes to the surface first, and is turned round in the next step. The point that
// goes deepest speaks for all with its normal: a body that comes flat stays so.
void PairState::turn_round_what_bounces(btScalar seconds) {
    struct Bounce {
        btManifoldPoint* point;
        btScalar gap, approach, pull;
        bool speculative;
        bool touches(btScalar in) const { return (approach + pull * in) * in >= gap; }
    };
    static thread_local std::vector<Bounce> bounces;
    bounces.clear();
    const btVector3 pull = acceleration_of(*object1) - acceleration_of(*object0);
    for (btPersistentManifold* manifold : patches.manifolds()) {
        for (int i = 0; i < manifold->getNumContacts(); ++i) {
            btManifoldPoint& point = manifold->getContactPoint(i);
            const btScalar approach = approach_at(point, *this);
            if (!(point.m_combinedRestitution > 0 && approach > least_approach)) continue;
            const auto found = std::ranges::find(candidates, CollisionDispatcher::key(point), &Candidate::key);
            if (found == candidates.end()) continue; // held
            bounces.push_back({&point, point.getDistance(), approach,
                               btMax(pull.dot(point.m_normalWorldOnB), btScalar(0)), found->speculative});
        }
    }
    const auto alike = [](const btVector3& a, const btVector3& normal) { return a.dot(normal) > like; };
    const std::vector<Owed> owed = std::exchange(owed_, {});
    for (const Bounce& b : bounces) {
        btManifoldPoint& point = *b.point;
        const btVector3& normal = point.m_normalWorldOnB;
        const auto before = std::ranges::find_if(owed, [&](const Owed& o) { return alike(o.normal, normal); });
        if (before == owed.end() && !b.speculative) continue; // touching: as without speculative contacts
        const Bounce* first = &b;
        for (const Bounce& other : bounces)
            if (alike(other.point->m_normalWorldOnB, normal)
                && other.gap - other.approach * seconds < first->gap - first->approach * seconds)
                first = &other;
        const Fall fall{first->pull, seconds};
        const btScalar energy = before != owed.end() ? before->energy : fall.energy(first->gap, first->approach);
        const btScalar away =
            fall.speed_away(first->gap, point.m_combinedRestitution * point.m_combinedRestitution * energy);
        if (away < 0 && first->touches(seconds)
            && std::ranges::none_of(owed_, [&](const Owed& o) { return alike(o.normal, normal); }))
            owed_.push_back({normal, energy});
        if (away < 0 || !b.touches(seconds)) {
            point.m_combinedRestitution = 0; // else Bullet would stop it above the surface
            continue;
        }
        point.m_combinedRestitution = away / first->approach;
        const PointKey key = CollisionDispatcher::key(point);
        turn_round(point, btMin(diagonal(leaf0(key)), diagonal(leaf1(key))), seconds);
    }
}

} // namespace raycontact::bullet
