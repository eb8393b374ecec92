// SPDX-License-Identifier: Apache-2.0
// Callbacks of Bullet's: which pairs the near callback is asked about, and how often those of contacts are called,
// against Bullet's own algorithms in the same scene.
#include "contact_events.h"
#include "test_world.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace raycontact::test {
namespace {

using Objects = std::pair<const btCollisionObject*, const btCollisionObject*>;

Objects objects_of(const btBroadphasePair& pair) {
    const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    return std::minmax(a, b);
}

struct Near {
    static inline std::vector<Objects> asked;
    static inline const btCollisionObject* refused = nullptr;

    static void filter(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
        asked.push_back(objects_of(pair));
        if (asked.back().first == refused || asked.back().second == refused) return;
        btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    }
    /// As users write it: what Bullet's own does, in their own words.
    static void by_hand(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
        auto* a = static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
        auto* b = static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
        if (!dispatcher.needsCollision(a, b)) return;
        const btCollisionObjectWrapper wrap_a(nullptr, a->getCollisionShape(), a, a->getWorldTransform(), -1, -1);
        const btCollisionObjectWrapper wrap_b(nullptr, b->getCollisionShape(), b, b->getWorldTransform(), -1, -1);
        if (!pair.m_algorithm)
            pair.m_algorithm = dispatcher.findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        btManifoldResult result(&wrap_a, &wrap_b);
        pair.m_algorithm->processCollision(&wrap_a, &wrap_b, info, &result);
    }
    Near() {
        asked.clear();
        refused = nullptr;
    }
};

/// A pile of everything: meshes, boxes, balls, compounds.
void fill(TestWorld& w) {
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    w.add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(-0.001)), 0, at(0, 0, 0));
    for (int i = 0; i < 4; ++i) {
        w.add_mesh(table(), 5, at(0.9 * i - 1.5, 0.2 * i, 0.41));
        w.add(std::make_unique<btSphereShape>(btScalar(0.2)), 1, at(0.9 * i - 1.5, 0.2 * i, 1));
        w.add(std::make_unique<btBoxShape>(btVector3(btScalar(0.2), btScalar(0.2), btScalar(0.1))), 1,
              at(0.9 * i - 1.2, 0.2 * i, 0.9));
    }
}

TEST(Callbacks, NearIsAskedAboutEveryPairOnce) {
    const Near near;
    TestWorld w;
    fill(w);
    w.dispatcher.setNearCallback(Near::filter);
    for (int i = 0; i < 30; ++i) {
        Near::asked.clear();
        w.steps(1);
        const btBroadphasePairArray& pairs = w.broadphase.getOverlappingPairCache()->getOverlappingPairArray();
        ASSERT_EQ(Near::asked.size(), std::size_t(pairs.size()));
        // In the broad phase's order, ours and Bullet's.
        for (std::size_t k = 0; k < Near::asked.size(); ++k)
            EXPECT_EQ(Near::asked[k], objects_of(pairs[static_cast<int>(k)]));
        EXPECT_EQ(w.dispatcher.stats().pairs + w.dispatcher.stats().other_pairs, Near::asked.size());
    }
    EXPECT_GT(w.dispatcher.stats().pairs, 10u);
    EXPECT_GT(w.dispatcher.stats().other_pairs, 1u);
}

TEST(Callbacks, NearChangesNothingByItself) {
    TestWorld plain, filtered, by_hand;
    for (TestWorld* w : {&plain, &filtered, &by_hand}) fill(*w);
    filtered.dispatcher.setNearCallback(Near::filter);
    by_hand.dispatcher.setNearCallback(Near::by_hand);
    for (TestWorld* w : {&plain, &filtered, &by_hand}) w->steps(90);
    for (std::size_t i = 0; i < plain.bodies.size(); ++i) {
        EXPECT_EQ(plain.bodies[i]->getWorldTransform(), filtered.bodies[i]->getWorldTransform()) << i;
        EXPECT_EQ(plain.bodies[i]->getWorldTransform(), by_hand.bodies[i]->getWorldTransform()) << i;
    }
}

TEST(Callbacks, NearRefusesAPair) {
    const Near near;
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    const btRigidBody& kept = w.add_mesh(table(), 5, at(-1, 0, 0.405));
    const btRigidBody& ghost = w.add_mesh(table(), 5, at(1, 0, 0.405));
    const btRigidBody& later = w.add(std::make_unique<btBoxShape>(btVector3(1, 1, 1) / 2), 5, at(0, 2, 0.505));
    w.dispatcher.setNearCallback(Near::filter);
    Near::refused = &ghost;
    w.steps(60);
    EXPECT_NEAR(double(kept.getWorldTransform().getOrigin().z()), 0.4, 0.01);
    EXPECT_LT(double(ghost.getWorldTransform().getOrigin().z()), -3);
    EXPECT_NEAR(double(later.getWorldTransform().getOrigin().z()), 0.5, 0.01);
    // Refused while it touches: its contacts go at once, in ours unlike in Bullet.
    Near::refused = &later;
    w.world.performDiscreteCollisionDetection();
    for (int i = 0; i < w.dispatcher.getNumManifolds(); ++i) {
        const btPersistentManifold& m = *w.dispatcher.getManifoldByIndexInternal(i);
        EXPECT_TRUE(m.getBody0() != &later && m.getBody1() != &later);
    }
    w.steps(60);
    EXPECT_LT(double(later.getWorldTransform().getOrigin().z()), -3);
    Near::refused = nullptr;
    w.dispatcher.setNearCallback(btCollisionDispatcher::defaultNearCallback);
    w.steps(1);
    EXPECT_GT(w.touching(), 0);
}

TEST(Callbacks, SleepingPairsKeepTheirsUnderANearCallback) {
    const Near near;
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.4));
    body.forceActivationState(ACTIVE_TAG);
    w.dispatcher.setNearCallback(Near::filter);
    w.steps(300);
    ASSERT_FALSE(body.isActive());
    EXPECT_EQ(w.dispatcher.stats().pairs, 0u);
    EXPECT_GT(w.touching(), 0);
}

/// needsCollision of a user's own dispatcher is asked, too.
TEST(Callbacks, NeedsCollisionIsAsked) {
    struct Choosy : bullet::CollisionDispatcher {
        using CollisionDispatcher::CollisionDispatcher;
        int asked = 0;
        bool needsCollision(const btCollisionObject*, const btCollisionObject*) override {
            ++asked;
            return false;
        }
    };
    for (const bool near : {false, true}) {
        btDefaultCollisionConfiguration configuration;
        Choosy dispatcher(&configuration);
        btDbvtBroadphase broadphase;
        btSequentialImpulseConstraintSolver solver;
        btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
        if (near) dispatcher.setNearCallback(Near::filter);
        bullet::MeshShape shape(table());
        btBoxShape box(btVector3(1, 1, 1));
        btRigidBody a(1, nullptr, &shape, btVector3(1, 1, 1)), b(1, nullptr, &box, btVector3(1, 1, 1));
        world.addRigidBody(&a);
        world.addRigidBody(&b);
        world.performDiscreteCollisionDetection();
        EXPECT_GE(dispatcher.asked, 1);
        EXPECT_EQ(dispatcher.stats().pairs, 0u);
        EXPECT_EQ(dispatcher.getNumManifolds(), 0);
        world.removeRigidBody(&a);
        world.removeRigidBody(&b);
    }
}

/// A box that lies on a floor for some steps, then is lifted off. Its finder differs.
struct Counts {
    int added, processed, destroyed, started, ended;
};
Counts lie(bool mesh) {
    const Events events;
    bullet::ManifoldSettings one_patch; // of ours a pair can have several manifolds, each with its start and end
    one_patch.patch_reach = 2;
    TestWorld w({}, one_patch);
    w.world.setGravity(btVector3(0, 0, 0));
    const btVector3 half(btScalar(0.5), btScalar(0.5), btScalar(0.5));
    w.add(std::make_unique<btBoxShape>(btVector3(3, 3, btScalar(0.5))), 0, at(0, 0, -0.5));
    btRigidBody& body = mesh ? w.add_mesh(Shape::make(box_mesh(1, 1, 1)), 1, at(0, 0, 0.49))
                             : w.add(std::make_unique<btBoxShape>(half), 1, at(0, 0, 0.49));
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    for (int i = 0; i < 10; ++i) w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(Events::bodies.size(), 2u);
    EXPECT_TRUE(Events::bodies.contains(static_cast<btCollisionObject*>(&body)));
    body.setWorldTransform(at(0, 0, 5));
    w.world.performDiscreteCollisionDetection();
    return {Events::added, Events::processed, Events::destroyed, Events::started, Events::ended};
}

// A mesh on a box is a pair of ours, a box on a box is Bullet's: four points in either.
TEST(Callbacks, OfContactsAreCalledAsBulletCallsThem) {
    const Counts ours = lie(true), bullets = lie(false);
    EXPECT_EQ(ours.added, bullets.added);
    EXPECT_EQ(ours.processed, bullets.processed);
    EXPECT_EQ(ours.destroyed, bullets.destroyed);
    EXPECT_EQ(ours.started, bullets.started);
    EXPECT_EQ(ours.ended, bullets.ended);
    EXPECT_EQ(ours.processed, 40);
}

TEST(Callbacks, ProcessedSeesPointsThatAreHeld) {
    const Events events;
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.399));
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(Events::processed, 16);
    body.setWorldTransform(at(0, 0, 0.405)); // 5 mm clear: held, as Bullet holds what is near
    w.world.performDiscreteCollisionDetection();
    EXPECT_EQ(Events::processed, 32);
}

/// A level of two sub-parts: the floor's left half in one, its right half in the other, each of four triangles.
struct TwoParts {
    std::vector<btScalar> vertices{-4, -2, 0, 0, -2, 0, 0, 2, 0, -4, 2, 0, -2, 0, 0,
                                   0,  -2, 0, 4, -2, 0, 4, 2, 0, 0,  2, 0, 2,  0, 0};
    std::vector<int> indices{0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
    btTriangleIndexVertexArray array;

    TwoParts() {
        for (int part = 0; part < 2; ++part) {
            btIndexedMesh mesh;
            mesh.m_numTriangles = 4;
            mesh.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices.data());
            mesh.m_triangleIndexStride = 3 * sizeof(int);
            mesh.m_numVertices = 5;
            mesh.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices.data() + part * 15);
            mesh.m_vertexStride = 3 * sizeof(btScalar);
            array.addIndexedMesh(mesh, PHY_INTEGER);
        }
    }
    /// Whether a point over the floor lies over this triangle, to a millimetre.
    bool lies_over(const btVector3& p, int part, int triangle) const {
        btVector3 corner[3];
        for (int k = 0; k < 3; ++k) {
            const btScalar* v = vertices.data() + part * 15
                                + 3 * indices[3 * static_cast<std::size_t>(triangle) + static_cast<std::size_t>(k)];
            corner[k].setValue(v[0], v[1], 0);
        }
        for (int k = 0; k < 3; ++k) {
            const btVector3 side = corner[(k + 1) % 3] - corner[k], to = p - corner[k];
            if (side.x() * to.y() - side.y() * to.x() < btScalar(-1e-3) * side.length()) return false;
        }
        return true;
    }
};

struct AddedPlace {
    btVector3 point;
    const btCollisionObject* object;
    int part, index;
};
std::vector<AddedPlace> added_places;

bool note_added(btManifoldPoint& p, const btCollisionObjectWrapper* a, int part0, int index0,
                const btCollisionObjectWrapper* b, int part1, int index1) {
    added_places.push_back({p.m_positionWorldOnA, a->getCollisionObject(), part0, index0});
    added_places.push_back({p.m_positionWorldOnB, b->getCollisionObject(), part1, index1});
    return false;
}

/// What is told of a floor of two sub-parts, and of what lies on it.
void expect_named(TestWorld& w, const TwoParts& level, const btRigidBody& floor) {
    const btRigidBody& box = w.add_mesh(Shape::make(box_mesh(1, 1, 0.4)), 5, at(-0.3, 0.1, 0.2));
    const btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.3)), 5, at(2.9, 0.4, 0.3));
    for (const auto& body : w.bodies)
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    added_places.clear();
    gContactAddedCallback = note_added;
    w.steps(30);
    gContactAddedCallback = nullptr;
    std::set<int> parts;
    std::size_t of_box = 0, of_ball = 0;
    for (const AddedPlace& place : added_places) {
        if (place.object == &floor) {
            ASSERT_TRUE(place.part >= 0 && place.part < 2 && place.index >= 0 && place.index < 4)
                << place.part << ", " << place.index;
            EXPECT_TRUE(level.lies_over(place.point, place.part, place.index)) << place.part << ", " << place.index;
            parts.insert(place.part);
        } else if (place.object == &box) {
            EXPECT_EQ(place.part, 0);
            EXPECT_TRUE(place.index >= 0 && place.index < 12) << place.index;
            ++of_box;
        } else {
            EXPECT_EQ(place.object, &ball);
            EXPECT_EQ(std::pair(place.part, place.index), std::pair(-1, -1));
            ++of_ball;
        }
    }
    EXPECT_EQ(parts, (std::set<int>{0, 1}));
    EXPECT_GT(of_box, 0u);
    EXPECT_GT(of_ball, 0u);
}

// Users look up a material by them.
TEST(Callbacks, AddedNamesSubPartsAndTrianglesOnBothSides) {
    TwoParts level;
    TestWorld w;
    expect_named(w, level, w.add(std::make_unique<btBvhTriangleMeshShape>(&level.array, true), 0, at(0, 0, 0)));
}

// By two numbers of Bullet's own, neither of which counts the triangles.
TEST(Callbacks, AddedNamesTrianglesOfAHeightFieldAsBulletDoes) {
    struct Triangles : btTriangleCallback {
        std::map<std::pair<int, int>, std::vector<btVector3>> by_name;
        void processTriangle(btVector3* t, int part, int index) override { by_name[{part, index}].assign(t, t + 3); }
        /// Whether the point lies over the triangle, to a millimetre.
        bool lies_over(const btVector3& p, const std::pair<int, int>& name) const {
            const std::vector<btVector3>& t = by_name.at(name);
            btScalar sides[3];
            for (std::size_t k = 0; k < 3; ++k) {
                const btVector3 side = t[(k + 1) % 3] - t[k], to = p - t[k];
                sides[k] = side.x() * to.y() - side.y() * to.x();
            }
            const auto [least, most] = std::minmax({sides[0], sides[1], sides[2]});
            return least > btScalar(-2e-3) || most < btScalar(2e-3);
        }
    };
    const std::vector<btScalar> heights(11 * 7, btScalar(0));
    TestWorld w;
    auto shape =
        std::make_unique<btHeightfieldTerrainShape>(11, 7, heights.data(), btScalar(-1), btScalar(1), 2, false);
    Triangles triangles;
    shape->processAllTriangles(&triangles, btVector3(-9, -9, -9), btVector3(9, 9, 9));
    ASSERT_EQ(triangles.by_name.size(), 120u);
    btRigidBody& field = w.add(std::move(shape), 0, at(0, 0, 0));
    btRigidBody& box = w.add_mesh(Shape::make(box_mesh(3.3, 2.4, 0.4)), 5, at(1.7, -0.6, 0.19));
    for (btRigidBody* body : {&field, &box})
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    added_places.clear();
    gContactAddedCallback = note_added;
    w.steps(1);
    gContactAddedCallback = nullptr;
    // And to those who ask.
    struct Asked : btCollisionWorld::ContactResultCallback {
        btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper* a, int part0, int index0,
                                 const btCollisionObjectWrapper* b, int part1, int index1) override {
            note_added(p, a, part0, index0, b, part1, index1);
            return 0;
        }
    } asked;
    w.world.contactPairTest(&field, &box, asked);
    std::set<std::pair<int, int>> names;
    for (const AddedPlace& place : added_places) {
        if (place.object != &field) continue;
        const std::pair name(place.part, place.index);
        ASSERT_TRUE(triangles.by_name.contains(name)) << place.part << ", " << place.index;
        EXPECT_TRUE(triangles.lies_over(place.point, name)) << place.part << ", " << place.index;
        names.insert(name);
    }
    EXPECT_GE(names.size(), 4u); // of the four corners
}

TEST(Callbacks, AddedNamesThePartsOfAGImpactMesh) {
    TwoParts level;
    TestWorld w;
    auto shape = std::make_unique<btGImpactMeshShape>(&level.array);
    shape->updateBound();
    expect_named(w, level, w.add(std::move(shape), 0, at(0, 0, 0)));
}

} // namespace
} // namespace raycontact::test
