// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

namespace raycontact::bullet {

/// What contactTest and contactPairTest need where Bullet has no algorithm: meshes against meshes, planes, fields.
class Queries {
public:
    Queries(const Settings& settings, ShapeCache& shapes) : scene_(settings), shapes_(shapes) {}

    /// Every contact between two leaves, given to `result`.
    void run(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, btManifoldResult& result);
    const Scene& scene() const { return scene_; } ///< with the contacts of the last call, its bodies gone

private:
    Scene scene_; ///< its own, since the dispatcher's keeps the last step's contacts
    ShapeCache& shapes_;
};

/// Owns an empty manifold: Bullet reads from a result's manifold which body comes first.
class QueryAlgorithm final : public btCollisionAlgorithm {
public:
    QueryAlgorithm(const btCollisionAlgorithmConstructionInfo& info, Queries& queries,
                   const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b)
        : btCollisionAlgorithm(info), queries_(queries),
          manifold_(m_dispatcher->getNewManifold(a.getCollisionObject(), b.getCollisionObject())) {}
    ~QueryAlgorithm() override { m_dispatcher->releaseManifold(manifold_); }
    QueryAlgorithm(const QueryAlgorithm&) = delete;
    QueryAlgorithm& operator=(const QueryAlgorithm&) = delete;

    void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                          btManifoldResult* result) override {
        result->setPersistentManifold(manifold_);
        queries_.run(*a, *b, *result);
    }
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return btScalar(1);
    }
    void getAllContactManifolds(btManifoldArray& out) override { out.push_back(manifold_); }

private:
    Queries& queries_;
    btPersistentManifold* manifold_;
};

struct QueryCreate final : btCollisionAlgorithmCreateFunc {
    explicit QueryCreate(Queries& q) : queries(q) {}
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override {
        void* place = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(QueryAlgorithm));
        return new (place) QueryAlgorithm(info, queries, *a, *b);
    }
    Queries& queries;
};

/// To Bullet's terms: on0 and on1 for a contact between a (body 0) and b (body 1).
void surface_points(const Contact& contact, btVector3& on_a, btVector3& on_b);
btVector3 normal_of(const Contact& contact);

} // namespace raycontact::bullet
