// SPDX-License-Identifier: Apache-2.0
#include <touches.h>

#include <pair.h>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <raycontact/settings.h>

namespace raycontact::bullet {

namespace {

/// Of its box in the broad phase.
btScalar size_of(const btCollisionObject& object) {
    const btBroadphaseProxy* proxy = object.getBroadphaseHandle();
    return proxy ? (proxy->m_aabbMax - proxy->m_aabbMin).length() : btScalar(BT_LARGE_FLOAT);
}

btVector3 velocity_at(const btCollisionObject& object, const btVector3& point) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body ? body->getVelocityInLocalPoint(point - body->getCenterOfMassPosition()) : btVector3(0, 0, 0);
}

/// What is nearest of a pair, by when it touches.
class Nearest {
public:
    Nearest(const PairState& pair, btScalar seconds) : pair_(pair), seconds_(seconds) {}

    void look(const btVector3& on0, const btVector3& on1, const btVector3& normal, btScalar distance) {
        const btScalar speed = (velocity_at(*pair_.object1, on1) - velocity_at(*pair_.object0, on0)).dot(normal);
        touches_ = touches_ || distance <= 0 || speed * seconds_ >= distance;
        any_ = true;
        const btScalar then = distance - speed * seconds_;
        if (then >= least_) return;
        least_ = then;
        touch_ = {pair_.object0, pair_.object1, (on0 + on1) / 2, normal, distance, speed};
    }
    bool any() const { return any_; }
    bool touches() const { return touches_; }
    const Touch& touch() const { return touch_; }

private:
    const PairState& pair_;
    btScalar seconds_;
    Touch touch_;
    btScalar least_ = BT_LARGE_FLOAT;
    bool any_ = false, touches_ = false;
};

} // namespace

void Touches::begin() {
    if (!in_dispatch_) begun_.clear(), ended_.clear(); // else the last one threw, and nobody was told
    ended_.insert(ended_.end(), gone_.begin(), gone_.end());
    gone_.clear();
    in_dispatch_ = true;
}

void Touches::update(PairState& pair, btScalar seconds) {
    Nearest nearest(pair, seconds);
    const btScalar trembles = btScalar(speculative_share) * btMin(size_of(*pair.object0), size_of(*pair.object1));
    bool stays = pair.candidates.empty() && !pair.patches.manifolds().empty(); // held
    for (const Candidate& c : pair.candidates) {
        nearest.look(c.on0, c.on1, c.normal, c.distance);
        stays = stays || c.distance <= trembles;
    }
    pair.each_child_manifold([&](const btPersistentManifold& m) {
        const bool turned = m.getBody0() != pair.object0;
        for (int i = 0; i < m.getNumContacts(); ++i) {
            const btManifoldPoint& p = m.getContactPoint(i);
            const btVector3 &a = p.getPositionWorldOnA(), &b = p.getPositionWorldOnB();
            nearest.look(turned ? b : a, turned ? a : b, turned ? -p.m_normalWorldOnB : p.m_normalWorldOnB,
                         p.getDistance());
            stays = true;
        }
    });
    if (pair.touch.object0 == nullptr) {
        if (!nearest.touches()) return;
        pair.touch = nearest.touch();
        ++count_;
        begun_.push_back(pair.touch);
    } else if (nearest.touches() || stays) {
        if (nearest.any()) pair.touch = nearest.touch();
    } else {
        end(pair);
    }
}

void Touches::end(PairState& pair) {
    if (pair.touch.object0 == nullptr) return;
    Touch last = pair.touch;
    last.speed = 0;
    pair.touch = {};
    --count_;
    (in_dispatch_ ? ended_ : gone_).push_back(last);
}

} // namespace raycontact::bullet
