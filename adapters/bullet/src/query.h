// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace raycontact::bullet {

/// What contactTest and contactPairTest need where Bullet has nothing to offer: meshes against meshes, planes, fields.
class Queries {
public:
    Queries(const Settings& settings, ShapeCache& shapes) : scene_(settings), shapes_(shapes) {}

    /// Every contact between two leaves, given to `result`.
    void run(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, btManifoldResult& result);

private:
    Scene scene_; ///< its own: the dispatcher's keeps the last step's contacts
    ShapeCache& shapes_;
};

class QueryAlgorithm final : public btCollisionAlgorithm {
public:
    QueryAlgorithm(const btCollisionAlgorithmConstructionInfo& info, Queries& queries)
        : btCollisionAlgorithm(info), queries_(queries) {}
    void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                          btManifoldResult* result) override {
        queries_.run(*a, *b, *result);
    }
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return btScalar(1);
    }
    void getAllContactManifolds(btManifoldArray&) override {}

private:
    Queries& queries_;
};

struct QueryCreate final : btCollisionAlgorithmCreateFunc {
    explicit QueryCreate(Queries& q) : queries(q) {}
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper*,
                                                   const btCollisionObjectWrapper*) override {
        void* place = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(QueryAlgorithm));
        return new (place) QueryAlgorithm(info, queries);
    }
    Queries& queries;
};

/// To Bullet's terms: on0 and on1 for a contact between a (body 0) and b (body 1).
void surface_points(const Contact& contact, btVector3& on_a, btVector3& on_b);
btVector3 normal_of(const Contact& contact);

} // namespace raycontact::bullet
