// SPDX-License-Identifier: Apache-2.0
#include <touches.h>

#include <pair.h>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>

#include <raycontact/settings.h>

namespace raycontact::bullet {

namespace {

/// Of its box in the broad phase.
btScalar size_of(const btCollisionObject& object) {
    const btBroadphaseProxy* proxy = object.getBroadphaseHandle();
    return proxy ? (proxy->m_aabbMax - proxy->m_aabbMin).length() : btScalar(BT_LARGE_FLOAT);
}

} // namespace

void Touches::begin() {
    if (!in_dispatch_) begun_.clear(), ended_.clear(); // else the last one threw, and nobody was told
    ended_.insert(ended_.end(), gone_.begin(), gone_.end());
    gone_.clear();
    in_dispatch_ = true;
}

void Touches::update(PairState& pair, btScalar seconds) {
    const btScalar trembles = btScalar(speculative_share) * btMin(size_of(*pair.object0), size_of(*pair.object1));
    bool stays = pair.candidates.empty() && !pair.patches.manifolds().empty(); // held
    bool touches = false;
    Touch nearest; // by when it touches
    btScalar least = BT_LARGE_FLOAT;
    const auto look = [&](const btVector3& on0, const btVector3& on1, const btVector3& normal, btScalar distance) {
        const btScalar speed = (velocity_at(*pair.object1, on1) - velocity_at(*pair.object0, on0)).dot(normal);
        touches = touches || distance <= 0 || speed * seconds >= distance;
        const btScalar then = distance - speed * seconds;
        if (then >= least) return;
        least = then;
        nearest = {pair.object0, pair.object1, (on0 + on1) / 2, normal, distance, speed};
    };
    for (const Candidate& c : pair.candidates) {
        look(c.on0, c.on1, c.normal, c.distance);
        stays = stays || c.distance <= trembles;
    }
    pair.each_child_manifold([&](const btPersistentManifold& m) {
        const bool turned = m.getBody0() != pair.object0;
        for (int i = 0; i < m.getNumContacts(); ++i) {
            const btManifoldPoint& p = m.getContactPoint(i);
            const btVector3 &a = p.getPositionWorldOnA(), &b = p.getPositionWorldOnB();
            look(turned ? b : a, turned ? a : b, turned ? -p.m_normalWorldOnB : p.m_normalWorldOnB, p.getDistance());
            stays = true;
        }
    });
    if (pair.touch.object0 == nullptr) {
        if (!touches) return;
        pair.touch = nearest;
        ++count_;
        begun_.push_back(pair.touch);
    } else if (touches || stays) {
        if (nearest.object0) pair.touch = nearest;
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
