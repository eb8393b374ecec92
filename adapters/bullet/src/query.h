// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <candidate.h>
#include <objects.h>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <memory>
#include <vector>

namespace raycontact::bullet {

/// What contactTest and contactPairTest need: the contacts of two objects of which RayContact handles a pair of leaves.
class Queries {
public:
    Queries(const Settings& settings, Objects& objects, ConvexShapes convex, btCollisionDispatcher& dispatcher)
        : scene_(touching(settings)), objects_(objects), convex_(convex), dispatcher_(dispatcher) {}

    /// Every contact between two shapes or their leaves, given to `result`. Where that asks for what is apart by up to
    /// a distance, balls and capsules answer in closed form, other convex shapes by Bullet's algorithm, meshes not.
    /// What cannot be used is left out, as in a dispatch.
    void run(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btDispatcherInfo& info,
             btManifoldResult& result);
    const Scene& scene() const { return scene_; } ///< with the contacts of the last pair of meshes, its bodies gone

private:
    struct Placed {
        Leaf leaf;
        btTransform pose; ///< world, as Bullet has it; the leaf's is rigid
        int index;
    };
    /// What is asked is whether two objects touch; nothing moves.
    static Settings touching(Settings settings) {
        settings.speculative = Speculative::off;
        return settings;
    }
    std::vector<Placed> leaves_of(const btCollisionObjectWrapper& wrap);
    void convert(Placed& placed, const btCollisionObjectWrapper& whole);
    void run_pair(Placed& a, Placed& b, const btCollisionObjectWrapper& whole_a,
                  const btCollisionObjectWrapper& whole_b, const btDispatcherInfo& info, btManifoldResult& result);
    void run_batch(const Placed& a, const Placed& b, std::vector<Candidate>& found);
    void run_bullet(const Placed& a, const Placed& b, const btCollisionObjectWrapper& whole_a,
                    const btCollisionObjectWrapper& whole_b, const btDispatcherInfo& info, btManifoldResult& result);

    Scene scene_; ///< its own, since the dispatcher's keeps the last step's contacts
    Objects& objects_;
    ConvexShapes convex_;
    btCollisionDispatcher& dispatcher_;
};

/// Owns a manifold: Bullet reads from a result's manifold which body comes first. It is none of the dispatcher's, so no
/// solver sees it: what a character asks about is in the world's pairs, too.
class QueryAlgorithm final : public btCollisionAlgorithm {
public:
    QueryAlgorithm(const btCollisionAlgorithmConstructionInfo& info, Queries& queries)
        : btCollisionAlgorithm(info), queries_(queries) {}
    QueryAlgorithm(const QueryAlgorithm&) = delete;
    QueryAlgorithm& operator=(const QueryAlgorithm&) = delete;

    /// Again and again for a pair of a ghost's own cache.
    void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                          const btDispatcherInfo& info, btManifoldResult* result) override;
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return btScalar(1);
    }
    void getAllContactManifolds(btManifoldArray& out) override {
        if (manifold_) out.push_back(manifold_.get());
    }

private:
    Queries& queries_;
    std::unique_ptr<btPersistentManifold> manifold_; ///< null: it has not run
};

} // namespace raycontact::bullet
