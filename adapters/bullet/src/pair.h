// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>
#include <patches.h>
#include <touches.h>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <memory>
#include <typeinfo>
#include <utility>
#include <vector>

namespace raycontact::bullet {

/// A pair of leaves that Bullet's own algorithms serve, inside a pair of objects that is ours (compounds of both).
struct ChildPair {
    int leaf0, leaf1;
    btCollisionAlgorithm* algorithm;
};

/// All that is kept of a pair of objects from step to step.
class PairState {
public:
    PairState(btCollisionDispatcher& dispatcher, Objects& objects, Touches& touches, const btCollisionObject* object0,
              const btCollisionObject* object1);
    ~PairState();
    PairState(const PairState&) = delete;
    PairState& operator=(const PairState&) = delete;

    /// Runs Bullet's algorithm for two leaves, which may be the whole objects, or drops it if their boxes are apart.
    void run_child(int leaf0, int leaf1, const Leaf& a, const Leaf& b, const btDispatcherInfo& info);
    /// Drops what was kept for old leaves if an object's leaves have changed.
    void check_versions(std::uint64_t version0, std::uint64_t version1);
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
    /// No contacts from now on, until the next update.
    void clear();

    const btCollisionObject* object0;
    const btCollisionObject* object1;
    Object &record0, &record1;
    std::vector<Candidate> candidates; ///< of this step
    Patches patches;
    Touch touch; ///< as last seen; without objects: they do not touch

private:
    void drop_child(const ChildPair& child);

    btCollisionDispatcher& dispatcher_;
    Objects& objects_;
    Touches& touches_;
    std::vector<ChildPair> children_;
    std::uint64_t version0_ = 0, version1_ = 0;
};

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
