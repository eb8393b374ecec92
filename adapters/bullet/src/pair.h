// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <leaf_pair.h>
#include <objects.h>
#include <patches.h>
#include <touches.h>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <memory>
#include <typeinfo>
#include <utility>
#include <vector>

namespace raycontact::bullet {

/// Algorithms lie in a pool of their dispatcher's.
struct BackToPool {
    btCollisionDispatcher* dispatcher;
    void operator()(btCollisionAlgorithm* algorithm) const {
        algorithm->~btCollisionAlgorithm();
        dispatcher->freeCollisionAlgorithm(algorithm);
    }
};
using PooledAlgorithm = std::unique_ptr<btCollisionAlgorithm, BackToPool>;
/// Bullet's own for two leaves, or objects: the findAlgorithm of our dispatcher is for whole objects.
inline PooledAlgorithm bullets_algorithm(btCollisionDispatcher& dispatcher, const btCollisionObjectWrapper& a,
                                         const btCollisionObjectWrapper& b, ebtDispatcherQueryType type) {
    return {dispatcher.btCollisionDispatcher::findAlgorithm(&a, &b, nullptr, type), BackToPool{&dispatcher}};
}

/// A pair of leaves that Bullet's own algorithms serve, inside a pair of objects that is ours (compounds of both).
struct ChildPair {
    int leaf0, leaf1;
    PooledAlgorithm algorithm;
};

/// All that is kept of a pair of objects from step to step.
class PairState {
public:
    PairState(btCollisionDispatcher& dispatcher, Touches& touches, const btCollisionObject& object0,
              const btCollisionObject& object1, std::shared_ptr<Object> record0, std::shared_ptr<Object> record1);
    /// The objects may be gone from the world, but Bullet cleans pairs before it forgets them.
    ~PairState() { clear(); }
    PairState(const PairState&) = delete;
    PairState& operator=(const PairState&) = delete;

    /// Runs Bullet's algorithm for two leaves, which may be the whole objects, or drops it if their boxes are apart.
    void run_child(const LeafPair& pair, const btDispatcherInfo& info);
    /// Drops what was kept for old leaves if an object's leaves have changed.
    void check_versions();
    void all_manifolds(btManifoldArray& out) const;
    /// Those of Bullet's algorithms for two leaves.
    template <class Visit>
    void each_child_manifold(Visit&& visit) const {
        static thread_local btManifoldArray found;
        for (const ChildPair& child : children_) {
            found.resizeNoInitialize(0);
            child.algorithm->getAllContactManifolds(found);
            for (int i = 0; i < found.size(); ++i) visit(*found[i]);
        }
    }
    /// For gContactAddedCallback.
    void name_places();
    /// After the callbacks: what Bullet's solver is told of speculative contacts, so that bodies bounce and roll.
    void tell_solver(btScalar seconds);
    /// No contacts from now on, until the next update.
    void clear();

    const btCollisionObject* object0;
    const btCollisionObject* object1;
    const std::shared_ptr<Object> record0, record1;
    std::vector<Candidate> candidates; ///< of this step
    Patches patches;
    Touch touch; ///< as last seen; without objects: they do not touch

private:
    void turn_round_what_bounces(btScalar seconds);
    const Leaf& leaf0(const PointKey& key) const { return record0->leaves[static_cast<std::size_t>(key.child0)]; }
    const Leaf& leaf1(const PointKey& key) const { return record1->leaves[static_cast<std::size_t>(key.child1)]; }

    /// What comes to the surface before it bounces.
    struct Owed {
        btVector3 normal;
        btScalar energy; ///< per kilogram, with which it came
    };

    btCollisionDispatcher& dispatcher_;
    Touches& touches_;
    std::vector<ChildPair> children_;
    std::vector<Owed> owed_; ///< of the step before
    std::uint64_t version0_ = 0, version1_ = 0;
};

/// Of its surface there, metres a second.
btVector3 velocity_at(const btCollisionObject& object, const btVector3& point);

/// Belongs to Bullet's broad-phase pair: when that is deleted, so are the manifolds. Small, because it lies in Bullet's
/// pool of algorithms, which does not check sizes.
class PairAlgorithm final : public btCollisionAlgorithm {
public:
    /// Without a state: the dispatcher gives it one when it takes the pair.
    explicit PairAlgorithm(const btCollisionAlgorithmConstructionInfo& info) : btCollisionAlgorithm(info) {}

    PairState* state() { return state_.get(); }
    void set_state(std::unique_ptr<PairState> state) { state_ = std::move(state); }
    /// Whether processCollision was called since the last time.
    bool take_wanted() { return std::exchange(wanted_, false); }
    /// Null for Bullet's own. Called for every pair in every step, so without dynamic_cast, which takes longer.
    static PairAlgorithm* of(btCollisionAlgorithm* algorithm) {
        return algorithm && typeid(*algorithm) == typeid(PairAlgorithm) ? static_cast<PairAlgorithm*>(algorithm)
                                                                        : nullptr;
    }

    /// The dispatcher works in a batch, later: this is how a near callback says that the pair belongs to it.
    void processCollision(const btCollisionObjectWrapper*, const btCollisionObjectWrapper*, const btDispatcherInfo&,
                          btManifoldResult*) override {
        wanted_ = true;
    }
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return btScalar(1);
    }
    void getAllContactManifolds(btManifoldArray& out) override {
        if (state_) state_->all_manifolds(out);
    }

private:
    std::unique_ptr<PairState> state_;
    bool wanted_ = false;
};

} // namespace raycontact::bullet
