// SPDX-License-Identifier: Apache-2.0
// From contacts to manifolds: signs, keys, impulses kept, patches, counters, callbacks, sleeping and filtered pairs.
#include "contact_events.h"
#include "test_world.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

namespace raycontact::test {
namespace {

using Key = std::tuple<int, int, int, FeatureKind, std::uint32_t>;
Key key(const btManifoldPoint& p) {
    const bullet::PointKey k = bullet::CollisionDispatcher::key(p);
    return {k.child0 * 1000 + k.child1, k.vertex_body, k.vertex, k.feature, k.other};
}

/// A pair of tables' size is one patch: four points for sixteen contacts.
bullet::ManifoldSettings one_patch() {
    bullet::ManifoldSettings settings;
    settings.patch_reach = 2;
    return settings;
}

template <class Visit>
void each_point(TestWorld& w, Visit&& visit) {
    for (int i = 0; i < w.dispatcher.getNumManifolds(); ++i) {
        btPersistentManifold& m = *w.dispatcher.getManifoldByIndexInternal(i);
        for (int k = 0; k < m.getNumContacts(); ++k) visit(m, m.getContactPoint(k));
    }
}

TEST(Manifold, SignsAndPlacesAreBullets) {
    for (const bool table_first : {false, true}) {
        TestWorld w({}, one_patch());
        if (!table_first) w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
        const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.39));
        if (table_first) w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
        w.world.performDiscreteCollisionDetection();
        EXPECT_EQ(w.dispatcher.stats().contacts, 16u);
        EXPECT_EQ(w.dispatcher.stats().points, 4u);
        EXPECT_EQ(w.dispatcher.stats().reduced_away, 12u);
        EXPECT_EQ(w.dispatcher.stats().manifolds, 1u);
        int points = 0;
        each_point(w, [&](btPersistentManifold& m, btManifoldPoint& p) {
            ++points;
            EXPECT_TRUE(bullet::CollisionDispatcher::is_ours(p));
            EXPECT_NEAR(double(p.getDistance()), -0.01, 1e-5);
            EXPECT_NEAR(double(p.m_normalWorldOnB.z()), m.getBody0() == &body ? 1 : -1, 1e-5);
            const btVector3 gap = p.m_positionWorldOnA - p.m_positionWorldOnB;
            EXPECT_NEAR(double(gap.dot(p.m_normalWorldOnB)), double(p.getDistance()), 1e-6);
            const btVector3 on_table = m.getBody0() == &body ? p.m_positionWorldOnA : p.m_positionWorldOnB;
            EXPECT_NEAR(double(on_table.z()), -0.01, 1e-5);
            EXPECT_NEAR(std::fabs(double(on_table.x())), 0.5, 1e-5); // the four outermost corners are kept
            EXPECT_NEAR(std::fabs(double(on_table.y())), 0.5, 1e-5);
            const btVector3 local = m.getBody0()->getWorldTransform()(p.m_localPointA);
            EXPECT_LT((local - p.m_positionWorldOnA).length(), btScalar(1e-5));
        });
        EXPECT_EQ(points, 4);
    }
}

// Constraints have no weight (Lehericey et al. 2013, section 2.1); the weights are in the scene's contacts.
TEST(Manifold, OfDirectionWeightedIsOfFaces) {
    Settings settings;
    settings.direction = Direction::weighted;
    TestWorld world(settings);
    world.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    for (int i = 0; i < 4; ++i) world.add_mesh(torus(), 1, at(0.1 * i, 0, 0.7 + 0.6 * i));
    std::size_t faces = 0;
    for (int step = 0; step < 180; ++step) {
        world.steps(1);
        for (const Contact& c : world.dispatcher.scene().contacts()) {
            if (c.feature.kind != FeatureKind::faces) continue;
            ++faces;
            ASSERT_GT(c.weight, 0);
            ASSERT_LT(c.weight, 1); // the tori's cross section
        }
        for (const auto& body : world.bodies) ASSERT_GT(body->getWorldTransform().getOrigin().z(), -0.6);
    }
    EXPECT_GT(faces, 1000u);
}

TEST(Manifold, DistantContactsHaveTheirOwnPatch) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    w.add_mesh(table(), 5, at(0, 0, 0.39));
    w.world.performDiscreteCollisionDetection();
    const bullet::DispatcherStats& stats = w.dispatcher.stats();
    EXPECT_EQ(stats.manifolds, 4u); // a foot each
    EXPECT_EQ(stats.points, 16u);
    EXPECT_EQ(stats.reduced_away, 0u);
}

TEST(Manifold, ImpulsesStayWithTheirKey) {
    TestWorld w({}, one_patch());
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    w.add_mesh(table(), 5, at(0, 0, 0.405));
    w.steps(120);
    std::map<Key, std::pair<btScalar, int>> before;
    each_point(w, [&](btPersistentManifold&, btManifoldPoint& p) {
        before[key(p)] = {p.getAppliedImpulse(), p.getLifeTime()};
    });
    ASSERT_EQ(before.size(), 4u);
    w.world.performDiscreteCollisionDetection(); // detection alone: the solver does not write impulses
    int kept = 0;
    btScalar sum = 0;
    each_point(w, [&](btPersistentManifold&, btManifoldPoint& p) {
        const auto old = before.find(key(p));
        if (old == before.end()) return;
        ++kept;
        EXPECT_EQ(p.getAppliedImpulse(), old->second.first);
        EXPECT_EQ(p.getLifeTime(), old->second.second + 1);
        EXPECT_GT(p.getLifeTime(), 20);
        sum += p.getAppliedImpulse();
    });
    EXPECT_EQ(kept, 4);
    EXPECT_NEAR(double(sum), 5 * 9.81 / 60, 0.1); // they carry its weight
    EXPECT_EQ(w.dispatcher.stats().points_matched + w.dispatcher.stats().points_held, 4u);
}

TEST(Manifold, SeveralPatchesAPair) {
    // A table pushed into a corner of floor and wall, both of one mesh: two directions must be held.
    Mesh corner = box_mesh(4, 4, 1);
    for (Vec3& v : corner.vertices) v.z -= 0.5;
    Mesh wall = box_mesh(1, 4, 3);
    const auto base = static_cast<std::uint32_t>(corner.vertices.size());
    for (const Vec3& v : wall.vertices) corner.vertices.push_back({v.x - 1, v.y, v.z + 1.4});
    for (const auto& t : wall.triangles) corner.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    TestWorld w;
    w.add_mesh(Shape::make(corner), 0, at(0, 0, 0));
    w.add_mesh(table(), 5, at(-0.01, 0, 0.39));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.dispatcher.stats().pairs, 1u);
    EXPECT_GE(w.dispatcher.stats().manifolds, 2u);
    bool up = false, aside = false;
    each_point(w, [&](btPersistentManifold& m, btManifoldPoint& p) {
        const btVector3 n = m.getBody0()->isStaticObject() ? -p.m_normalWorldOnB : p.m_normalWorldOnB;
        up = up || n.z() > btScalar(0.9);
        aside = aside || n.x() > btScalar(0.9);
    });
    EXPECT_TRUE(up);
    EXPECT_TRUE(aside);
    EXPECT_EQ(w.dispatcher.stats().points + w.dispatcher.stats().reduced_away, w.dispatcher.stats().contacts);
    btManifoldArray all;
    btBroadphasePair& pair = w.broadphase.getOverlappingPairCache()->getOverlappingPairArray()[0];
    pair.m_algorithm->getAllContactManifolds(all);
    EXPECT_EQ(std::uint64_t(all.size()), w.dispatcher.stats().manifolds);
}

// As a patch for all that a pair has asks for it: a reach beyond every size must not make all points one place.
TEST(Manifold, APatchOfAnyReachKeepsFourPoints) {
    TestWorld w({}, {btScalar(-1), btScalar(1e9), 0});
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    w.add_mesh(table(), 5, at(0, 0, 0.39));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.dispatcher.stats().manifolds, 1u);
    EXPECT_EQ(w.dispatcher.stats().points, 4u);
    double low = 1, high = -1;
    each_point(w, [&](btPersistentManifold&, btManifoldPoint& p) {
        low = std::min(low, double(p.getPositionWorldOnA().x()));
        high = std::max(high, double(p.getPositionWorldOnA().x()));
    });
    EXPECT_GT(high - low, 0.9); // of a table of 1 m
}

TEST(Manifold, PointsAreHeldForAWhile) {
    TestWorld w({}, one_patch());
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.399));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.dispatcher.stats().points, 4u);
    body.setWorldTransform(at(0, 0, 0.405)); // 5 mm clear
    for (int i = 0; i < 8; ++i) {
        w.world.performDiscreteCollisionDetection();
        EXPECT_EQ(w.dispatcher.stats().contacts, 0u);
        EXPECT_EQ(w.dispatcher.stats().points_held, 4u) << i;
    }
    each_point(w, [](btPersistentManifold&, btManifoldPoint& p) { EXPECT_NEAR(double(p.getDistance()), 0.005, 1e-5); });
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.touching(), 0);

    body.setWorldTransform(at(0, 0, 0.399));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.dispatcher.stats().points, 4u);
    body.setWorldTransform(at(0, 0, 0.43)); // out of the breaking threshold, the boxes still overlap
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.touching(), 0);
}

TEST(Manifold, ContactCallbacks) {
    const Events events;
    TestWorld w({}, one_patch());
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.39));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(Events::added, 0); // nobody asked for it
    EXPECT_EQ(Events::started, 1);
    each_point(w, [](btPersistentManifold&, btManifoldPoint& p) {
        EXPECT_NEAR(double(p.m_combinedFriction), 0.64, 1e-5); // 0.8 x 0.8, as Bullet combines them
    });
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(Events::added, 4);
    EXPECT_EQ(Events::started, 1);
    EXPECT_EQ(Events::ended, 0);
    each_point(w, [](btPersistentManifold&, btManifoldPoint& p) { EXPECT_EQ(p.m_combinedFriction, Events::friction); });
    body.setWorldTransform(at(0, 0, 5));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(Events::ended, 1);
}

TEST(Manifold, SleepingPairsKeepTheirs) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.395));
    body.forceActivationState(ACTIVE_TAG);
    w.steps(300);
    ASSERT_FALSE(body.isActive());
    EXPECT_EQ(w.dispatcher.stats().pairs, 0u); // no work for them
    EXPECT_GT(w.touching(), 0);                // but nothing lost
    body.activate(true);
    w.steps(1);
    EXPECT_EQ(w.dispatcher.stats().pairs, 1u);
}

TEST(Manifold, KeepStepsBeyondItsCounterIsRefused) {
    btDefaultCollisionConfiguration configuration;
    bullet::ManifoldSettings settings;
    for (const int steps : {-1, 256, 1000000}) {
        settings.keep_steps = steps;
        try {
            const bullet::CollisionDispatcher dispatcher(&configuration, {}, settings);
            FAIL() << steps << " was taken";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("keep_steps"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("255"), std::string::npos) << error.what();
        }
    }
    for (const int steps : {0, 255}) {
        settings.keep_steps = steps;
        EXPECT_NO_THROW(bullet::CollisionDispatcher(&configuration, {}, settings));
    }
    // Held all that time, and then no more.
    TestWorld w({}, settings);
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.399));
    w.world.performDiscreteCollisionDetection();
    body.setWorldTransform(at(0, 0, 0.405));
    for (int i = 0; i < 255; ++i) {
        w.world.performDiscreteCollisionDetection();
        ASSERT_GT(w.dispatcher.stats().points_held, 0u) << i;
    }
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(w.dispatcher.stats().points, 0u);
}

TEST(Manifold, FilteredPairsAreLeftOut) {
    TestWorld w;
    btRigidBody& ground = w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.39));
    body.setIgnoreCollisionCheck(&ground, true);
    w.steps(60);
    EXPECT_EQ(w.dispatcher.stats().pairs, 0u);
    EXPECT_LT(double(body.getWorldTransform().getOrigin().z()), -1);
}

} // namespace
} // namespace raycontact::test
