// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <gtest/gtest.h>

#include <set>

namespace raycontact::test {

/// Counts Bullet's callbacks of contacts while it lives.
struct Events {
    static inline int added = 0, processed = 0, destroyed = 0, started = 0, ended = 0;
    static inline std::set<const void*> bodies;
    static inline int data = 0;
    static constexpr btScalar friction = btScalar(0.125); ///< given to points that are added
    static bool on_added(btManifoldPoint& p, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*,
                         int, int) {
        ++added;
        p.m_userPersistentData = &data;
        p.m_combinedFriction = friction;
        return true;
    }
    static bool on_processed(btManifoldPoint& p, void* a, void* b) {
        ++processed;
        bodies.insert(a);
        bodies.insert(b);
        EXPECT_LT(p.getDistance(), gContactBreakingThreshold);
        return true;
    }
    static bool on_destroyed(void* user) {
        ++destroyed;
        EXPECT_EQ(user, &data);
        return true;
    }
    static void on_started(btPersistentManifold* const&) { ++started; }
    static void on_ended(btPersistentManifold* const&) { ++ended; }
    Events() {
        added = processed = destroyed = started = ended = 0;
        bodies.clear();
        gContactAddedCallback = on_added;
        gContactProcessedCallback = on_processed;
        gContactDestroyedCallback = on_destroyed;
        gContactStartedCallback = on_started;
        gContactEndedCallback = on_ended;
    }
    ~Events() {
        gContactAddedCallback = nullptr;
        gContactProcessedCallback = nullptr;
        gContactDestroyedCallback = nullptr;
        gContactStartedCallback = nullptr;
        gContactEndedCallback = nullptr;
    }
};

} // namespace raycontact::test
