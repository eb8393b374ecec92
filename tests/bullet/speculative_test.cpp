// SPDX-License-Identifier: Apache-2.0
// Speculative contacts, which a Bullet world has by default: bodies stop at the surface.
#include "test_world.h"

#include <convert.h>
#include <objects.h>
#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace raycontact::test {
namespace {

/// What a user has who says nothing, and who does without.
const Settings by_default;
const Settings without = [] {
    Settings settings;
    settings.speculative = Speculative::off;
    return settings;
}();

struct Flight {
    std::shared_ptr<const Shape> shape;
    double speed; ///< down, m/s
    btVector3 spin;
    double start = 3; ///< metres above a slab of 5 cm
    bool slab_gives_way = false;
};

// Whether the body is still above the slab after a second.
bool is_stopped(const Flight& flight, const Settings& settings) {
    TestWorld w(settings);
    w.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    btRigidBody& slab = w.add_mesh(Shape::make(box_mesh(8, 8, 0.05)), flight.slab_gives_way ? 2000 : 0, at(0, 0, 0));
    if (flight.slab_gives_way) slab.setGravity(btVector3(0, 0, 0));
    btRigidBody& body = w.add_mesh(flight.shape, 1, at(0.1, 0.2, flight.start));
    body.setLinearVelocity(btVector3(0, 0, btScalar(-flight.speed)));
    body.setAngularVelocity(flight.spin);
    w.steps(60);
    return body.getWorldTransform().getOrigin().z() > slab.getWorldTransform().getOrigin().z();
}

std::shared_ptr<const Shape> small_torus() {
    return bullet::stretch_shape(*torus(), {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3});
}

TEST(Speculative, AFastTorusDoesNotPassAThinSlab) {
    for (const double speed : {20.0, 45.0, 100.0}) {
        int stopped = 0, stopped_without = 0;
        constexpr int flights = 8;
        for (int i = 0; i < flights; ++i) {
            const Flight flight{small_torus(), speed, btVector3(3, 1, 2), 3 + speed / 60 * i / flights};
            stopped += is_stopped(flight, by_default);
            stopped_without += is_stopped(flight, without);
        }
        EXPECT_EQ(stopped, flights) << speed << " m/s";
        EXPECT_LT(stopped_without, flights) << "else nothing is shown, at " << speed << " m/s";
    }
}

TEST(Speculative, NorDoesACoarseTableOrASlabThatGivesWay) {
    EXPECT_TRUE(is_stopped({table(), 30, btVector3(0, 0, 0)}, by_default));
    EXPECT_TRUE(is_stopped({table(), 30, btVector3(1, 5, 0)}, by_default));
    EXPECT_TRUE(is_stopped({small_torus(), 30, btVector3(1, 5, 0), 3, true}, by_default));
}

// Nothing holds or lifts a body that is on its way to the ground.
TEST(Speculative, NothingIsTouchedEarly) {
    TestWorld w;
    w.world.setGravity(btVector3(0, 0, 0));
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& body = w.add_mesh(torus(), 1, at(0, 0, 1.5));
    body.setLinearVelocity(btVector3(0, 0, -12)); // 20 cm a step
    std::uint64_t before_touch = 0;
    for (int i = 0; i < 8; ++i) {
        const double before = double(body.getWorldTransform().getOrigin().z());
        w.steps(1);
        const double now = double(body.getWorldTransform().getOrigin().z());
        btVector3 low, high;
        body.getCollisionShape()->getAabb(body.getWorldTransform(), low, high);
        EXPECT_GT(double(low.z()), -0.01) << "step " << i;
        EXPECT_LT(w.dispatcher.scene().stats().depth_max, 0.01);
        before_touch += w.dispatcher.scene().stats().contacts_speculative;
        EXPECT_LE(now, before + 1e-4);
        if (double(low.z()) > 0.25) {
            EXPECT_NEAR(before - now, 0.2, 1e-3) << "step " << i;
        }
    }
    EXPECT_GT(before_touch, 0u);
}

using Ground = std::unique_ptr<btCollisionShape> (*)();

std::unique_ptr<btCollisionShape> mesh_ground() {
    Mesh mesh = box_mesh(20, 20, 2);
    for (Vec3& v : mesh.vertices) v.z -= 1;
    return std::make_unique<bullet::MeshShape>(Shape::make(mesh));
}
std::unique_ptr<btCollisionShape> plane_ground() {
    return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
}

struct Impact {
    double restitution, speed; ///< down, m/s
    double slop = 0.002;
    int split_impulse = 1;
    std::shared_ptr<const Shape> shape = table();
    bool soft = false;
};

/// The part of its speed that a body has after it hit a slab.
double bounce(const Settings& settings, const Impact& impact) {
    TestWorld w(settings);
    w.world.setGravity(btVector3(0, 0, 0));
    w.world.getSolverInfo().m_linearSlop = btScalar(impact.slop);
    w.world.getSolverInfo().m_splitImpulse = impact.split_impulse;
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5)).setRestitution(1);
    btRigidBody& body = w.add_mesh(impact.shape, 5, at(0, 0, 1));
    body.setRestitution(btScalar(impact.restitution));
    body.setLinearVelocity(btVector3(0, 0, btScalar(-impact.speed)));
    if (impact.soft) body.setContactStiffnessAndDamping(10, 100);
    w.steps(static_cast<int>(std::ceil(60 * 1.5 / impact.speed)));
    return double(body.getLinearVelocity().z()) / impact.speed;
}

TEST(Speculative, BodiesBounceAsWithout) {
    for (const double restitution : {0.0, 0.3, 0.9}) {
        for (const double speed : {2.0, 5.0, 12.0}) {
            const Impact impact{restitution, speed};
            EXPECT_NEAR(bounce(by_default, impact), restitution, 0.005) << speed;
            if (restitution > 0) { // Bullet's solver adds what pushes it out
                EXPECT_NEAR(bounce(without, impact), restitution, 0.07) << speed;
            }
        }
    }
}

// Nor does the way that splits depth from speed, nor how soft the contact is.
TEST(Speculative, NoSlopTakesFromTheRebound) {
    const auto small = Shape::make(box_mesh(0.1, 0.1, 0.1));
    for (const double slop : {0.0, 0.001, 0.005, 0.01, 0.1}) {
        for (const double speed : {1.0, 3.0}) {
            for (const int split : {0, 1})
                EXPECT_NEAR(bounce(by_default, {0.9, speed, slop, split}), 0.9, 0.005)
                    << slop << ' ' << speed << ' ' << split;
            EXPECT_NEAR(bounce(by_default, {0.9, speed, slop, 1, small}), 0.9, 0.005) << slop << ' ' << speed;
        }
    }
    // Slower than 0.2 m/s after the impact.
    EXPECT_NEAR(bounce(by_default, {0.3, 0.5, 0.01, 1, small}), 0.3, 0.005);
    const Impact soft{0.9, 1, 0, 1, table(), true};
    EXPECT_LT(bounce(without, soft), 0.85) << "else nothing is shown";
    EXPECT_NEAR(bounce(by_default, soft), bounce(without, soft), 0.01);
}

TEST(Speculative, EachReboundIsAsThatBefore) {
    for (const double slop : {0.0, 0.01}) {
        for (const Ground ground : {mesh_ground, plane_ground}) {
            TestWorld w;
            w.world.getSolverInfo().m_linearSlop = btScalar(slop);
            w.add(ground(), 0, at(0, 0, 0)).setRestitution(1);
            btRigidBody& body = w.add_mesh(torus(), 5, at(0, 0, 1.5));
            body.setRestitution(btScalar(0.9));
            int rebounds = 0;
            while (rebounds < 6) {
                const double before = double(body.getLinearVelocity().z());
                w.steps(1);
                const double after = double(body.getLinearVelocity().z());
                if (before >= 0 || after <= 0) continue;
                ++rebounds;
                EXPECT_NEAR(after / -before, 0.9, 0.018)
                    << slop << ", rebound " << rebounds << ", plane: " << (ground == plane_ground);
            }
        }
    }
}

// What the solver is told is no depth: the point's places and what the callbacks get are true.
TEST(Speculative, APointThatBouncesIsWhereItIs) {
    TestWorld w;
    w.world.setGravity(btVector3(0, 0, 0));
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5)).setRestitution(1);
    btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.41));
    body.setRestitution(1);
    body.setLinearVelocity(btVector3(0, 0, -3));
    static btScalar least; // a callback has no state
    least = 1;
    gContactProcessedCallback = [](btManifoldPoint& point, void*, void*) {
        least = btMin(least, point.getDistance());
        return true;
    };
    w.steps(1);
    gContactProcessedCallback = nullptr;
    EXPECT_NEAR(double(least), 0.01, 1e-4);
    ASSERT_GT(w.touching(), 0);
    const btManifoldPoint& point = w.dispatcher.getManifoldByIndexInternal(0)->getContactPoint(0);
    const btVector3 gap = point.m_positionWorldOnA - point.m_positionWorldOnB;
    EXPECT_NEAR(double(btFabs(gap.z())), 0.01, 1e-4);
    EXPECT_LT(double(point.getDistance()), -0.1);
}

double size_of(const Shape& shape) {
    const Vec3 low = shape.box_min(), high = shape.box_max();
    return std::hypot(high.x - low.x, high.y - low.y, high.z - low.z);
}

/// Part of its size that a body goes deep which falls, the most of six that lie otherwise; Bullet's own solver
/// settings.
double deepest_of_falls(const Settings& settings, const std::shared_ptr<const Shape>& shape, double height,
                        Ground ground = mesh_ground) {
    TestWorld w(settings);
    w.world.getSolverInfo() = btContactSolverInfo();
    w.add(ground(), 0, at(0, 0, 0));
    std::vector<const btRigidBody*> bodies;
    for (int i = 0; i < 6; ++i) {
        const int column = i % 3, row = i / 3;
        btTransform pose = at(4 * column - 4, 4 * row - 2, height + shape->radius());
        pose.setRotation(btQuaternion(btVector3(1, 2, btScalar(i)).normalized(), btScalar(i)));
        bodies.push_back(&w.add_mesh(shape, 5, pose));
    }
    double deepest = 0;
    for (int i = 0; i < 180; ++i) {
        w.steps(1);
        for (const btRigidBody* body : bodies) {
            const Pose pose = bullet::to_pose(body->getWorldTransform());
            for (const Vec3& v : shape->vertices()) deepest = std::max(deepest, -transform_point(pose, v).z);
        }
    }
    return deepest / size_of(*shape);
}

TEST(Speculative, NoFallGoesDeep) {
    const auto bunny = Shape::make(scenes::scene_model("bunny", 900).mesh);
    for (const auto& shape : {table(), torus(), bunny, small_torus(), Shape::make(box_mesh(0.3, 0.3, 0.3))}) {
        for (const double height : {1.0, 3.0, 10.0}) {
            // One that is stopped at a side turns in the same step: the other side comes faster than was expected.
            const bool is_fast = std::sqrt(2 * 9.81 * height) / 60 > 0.5 * size_of(*shape);
            const double most = is_fast ? 0.03 : 0.02;
            for (const Ground ground : {mesh_ground, plane_ground})
                EXPECT_LT(deepest_of_falls(by_default, shape, height, ground), most)
                    << size_of(*shape) << " m from " << height << ", plane: " << (ground == plane_ground);
            EXPECT_GT(deepest_of_falls(without, shape, height), 0.04) << "else nothing is shown";
        }
    }
}

/// A prism with z from -height/2 to height/2.
Mesh prism_mesh(std::uint32_t corners, double radius, double height) {
    Mesh mesh;
    for (const double z : {-height / 2, height / 2}) {
        for (std::uint32_t i = 0; i < corners; ++i) {
            const double angle = 2 * std::numbers::pi * i / corners;
            mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
        }
    }
    for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t next = (i + 1) % corners;
        mesh.triangles.push_back({i, next, corners + next});
        mesh.triangles.push_back({i, corners + next, corners + i});
        if (i == 0 || next == 0) continue;
        mesh.triangles.push_back({0, next, i});
        mesh.triangles.push_back({corners, corners + i, corners + next});
    }
    return mesh;
}

// The bar reaches over the prism on both sides: edges alone meet, but for the first angle, where its ends are over two
// corners.
TEST(Speculative, ABarComesToRestOnAPrism) {
    for (const double slop : {0.0, 0.001}) {
        for (const double degrees : {0.0, 10.0, 20.0, 30.0}) {
            TestWorld w;
            w.world.getSolverInfo().m_linearSlop = btScalar(slop);
            w.add_mesh(Shape::make(prism_mesh(6, 0.5, 0.2)), 0, at(0, 0, -0.1));
            btTransform pose = at(0, 0, 0.11);
            pose.setRotation(btQuaternion(btVector3(0, 0, 1), btScalar(degrees) * SIMD_RADS_PER_DEG));
            const btRigidBody& bar = w.add_mesh(Shape::make(box_mesh(1, 0.08, 0.02)), 1, pose);
            double deepest = 0, fastest = 0;
            bool edges_alone = true;
            for (int i = 0; i < 240; ++i) {
                w.steps(1);
                deepest = std::max(deepest, w.dispatcher.scene().stats().depth_max);
                for (const Contact& c : w.dispatcher.scene().contacts())
                    edges_alone = edges_alone && c.feature.kind == FeatureKind::edges;
                if (i < 60) continue;
                fastest = std::max(fastest, double(bar.getLinearVelocity().length()));
                fastest = std::max(fastest, 0.04 * double(bar.getAngularVelocity().length()));
            }
            EXPECT_EQ(edges_alone, degrees > 0) << degrees;
            EXPECT_LT(deepest, slop + 1e-4) << degrees;
            EXPECT_LT(fastest, 1e-3) << degrees;
            EXPECT_NEAR(double(bar.getWorldTransform().getOrigin().z()), 0.01 - slop, 1e-4) << degrees;
        }
    }
}

// Edges touch once they are some perturbations deep (docs/internals/edges.md); until then they must be near.
TEST(Speculative, NoDepthIsWithoutContact) {
    const auto prism = Shape::make(prism_mesh(6, 0.5, 0.2)), bar = Shape::make(box_mesh(1, 0.08, 0.02));
    Settings settings;
    settings.speculative = Speculative::on;
    int touching = 0, near = 0;
    for (double depth = 1e-9; depth < 1e-5; depth *= 1.05) {
        Scene scene(settings);
        const BodyId ground = scene.add(prism, bullet::to_pose(at(0, 0, -0.1)));
        Pose pose;
        pose.translation.z = 0.01 - depth;
        const std::array pair{Pair{ground, scene.add(bar, pose)}};
        EXPECT_GE(scene.find_contacts(pair).size(), 4u) << depth;
        (scene.stats().contacts > 0 ? touching : near) += 1;
    }
    EXPECT_GT(touching, 20);
    EXPECT_GT(near, 20);
}

// The children of a compound that a body may meet on its way are asked, and no others.
TEST(Speculative, AFastTorusDoesNotPassTilesOfACompound) {
    for (const double speed : {5.0, 20.0, 100.0}) {
        TestWorld w;
        const auto& tile = w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(0.5, 0.5, 0.05))));
        auto floor = std::make_unique<btCompoundShape>();
        for (int i = 0; i < 20; ++i)
            for (int k = 0; k < 20; ++k)
                floor->addChildShape(at(0.5 * i - 5, 0.5 * k - 5, 0), const_cast<bullet::MeshShape*>(&tile));
        w.add(std::move(floor), 0, at(0, 0, 0));
        btRigidBody& body = w.add_mesh(small_torus(), 1, at(0.1, 0.2, 3));
        body.setLinearVelocity(btVector3(0, 0, btScalar(-speed)));
        body.setAngularVelocity(btVector3(3, 1, 2));
        std::uint64_t pairs = 0;
        for (int i = 0; i < 60; ++i) {
            w.steps(1);
            pairs = std::max(pairs, w.dispatcher.stats().mesh_pairs);
        }
        EXPECT_GT(double(body.getWorldTransform().getOrigin().z()), 0) << speed;
        EXPECT_LT(pairs, speed < 10 ? 20u : 150u) << speed;
    }
}

std::vector<std::unique_ptr<btConvexInternalShape>> round_shapes() {
    std::vector<std::unique_ptr<btConvexInternalShape>> all;
    all.push_back(std::make_unique<btSphereShape>(btScalar(0.3)));
    all.push_back(std::make_unique<btCapsuleShapeZ>(btScalar(0.1), btScalar(0.6)));
    all.push_back(std::make_unique<btCapsuleShapeX>(btScalar(0.1), btScalar(0.6)));
    return all;
}

TEST(Speculative, AFastBallOrCapsuleDoesNotPassASheetOrAMeshABall) {
    for (const double speed : {5.0, 20.0, 100.0}) {
        int passed_without = 0;
        for (int i = 0; i < 8; ++i) {
            for (const Settings& settings : {by_default, without}) {
                for (auto& shape : round_shapes()) {
                    TestWorld w(settings);
                    w.add_mesh(Shape::make(box_mesh(8, 8, 0.001)), 0, at(0, 0, 0));
                    btRigidBody& body = w.add(std::move(shape), 1, at(0.1, 0.2, 2 + speed / 60 * i / 8));
                    body.setLinearVelocity(btVector3(btScalar(0.3 * speed), 0, btScalar(-speed)));
                    w.steps(static_cast<int>(60 * 2.5 / speed) + 3);
                    const bool passed = body.getWorldTransform().getOrigin().z() < 0;
                    passed_without += passed && settings.speculative == Speculative::off;
                    EXPECT_FALSE(passed && settings.speculative != Speculative::off)
                        << speed << ", flight " << i << ", " << body.getCollisionShape()->getName();
                }
            }
            TestWorld w;
            w.world.setGravity(btVector3(0, 0, 0));
            w.add(std::make_unique<btSphereShape>(btScalar(0.3)), 0, at(0, 0, 0));
            btRigidBody& plate = w.add_mesh(Shape::make(box_mesh(1, 1, 0.02)), 1, at(0, 0, 2 + speed / 60 * i / 8));
            plate.setLinearVelocity(btVector3(0, 0, btScalar(-speed)));
            w.steps(static_cast<int>(60 * 2.5 / speed) + 3);
            EXPECT_GT(double(plate.getWorldTransform().getOrigin().z()), 0.3) << speed << ", flight " << i;
        }
        if (speed > 50) {
            EXPECT_GT(passed_without, 0) << "else nothing is shown";
        }
    }
}

// It rolls on a floor, past a box, and stops at the wall.
TEST(Speculative, ABallIsStoppedByWhatIsInItsWayAlone) {
    TestWorld w;
    w.add_mesh(Shape::make(box_mesh(40, 8, 1)), 0, at(0, 0, -0.5));
    w.add_mesh(Shape::make(box_mesh(1, 1, 1)), 0, at(-2, 0.85, 0.5)); // 5 cm beside its way
    w.add_mesh(Shape::make(box_mesh(0.01, 8, 2)), 0, at(10, 0, 1));
    btRigidBody& ball = w.add(std::make_unique<btSphereShape>(btScalar(0.3)), 1, at(-15, 0, 0.3));
    ball.setFriction(0);
    ball.setLinearVelocity(btVector3(50, 0, 0));
    for (int i = 0; i < 28; ++i) {
        w.steps(1);
        EXPECT_NEAR(double(ball.getLinearVelocity().x()), 50, 1e-3) << "step " << i;
        EXPECT_NEAR(double(ball.getLinearVelocity().y()), 0, 1e-3) << "step " << i;
        EXPECT_NEAR(double(ball.getWorldTransform().getOrigin().z()), 0.3, 3e-3) << "step " << i;
    }
    w.steps(10);
    EXPECT_NEAR(double(ball.getWorldTransform().getOrigin().x()), 10 - 0.305, 2e-3);
}

// What is near is no contact for a query. All is tilted: the boxes of the two overlap.
TEST(Speculative, QueriesFindWhatTouches) {
    const btTransform tilted(btQuaternion(btVector3(1, 0, 0), btScalar(0.3)));
    Settings asked;
    asked.speculative = Speculative::on;
    for (const Settings& settings : {by_default, asked}) {
        TestWorld w(settings);
        btRigidBody& ground = w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, tilted * at(0, 0, -0.5));
        btRigidBody& body = w.add_mesh(table(), 5, tilted * at(0, 0, 0.401));
        for (const double gap : {0.001, -0.001}) {
            body.setWorldTransform(tilted * at(0, 0, 0.4 + gap));
            w.world.performDiscreteCollisionDetection();
            EXPECT_GT(w.dispatcher.stats().contacts, 0u);
            EXPECT_EQ(w.dispatcher.scene().stats().contacts > 0, gap < 0);
            Count pair, all;
            w.world.contactPairTest(&body, &ground, pair);
            w.world.contactTest(&body, all);
            EXPECT_EQ(pair.points > 0, gap < 0);
            EXPECT_EQ(all.points > 0, gap < 0);
        }
    }
}

TEST(Speculative, AUserCanDoWithout) {
    TestWorld w(without);
    w.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 1));
    for (int i = 0; i < 120; ++i) {
        w.steps(1);
        EXPECT_EQ(w.dispatcher.scene().stats().contacts_speculative, 0u);
        EXPECT_EQ(w.dispatcher.scene().contacts().size(), w.dispatcher.stats().contacts);
        // Only a point that is held, and was deep, may be near.
        for (int m = 0; m < w.dispatcher.getNumManifolds(); ++m) {
            const btPersistentManifold& manifold = *w.dispatcher.getManifoldByIndexInternal(m);
            if (w.dispatcher.stats().points_held > 0) continue;
            for (int k = 0; k < manifold.getNumContacts(); ++k)
                EXPECT_LT(double(manifold.getContactPoint(k).getDistance()), 0);
        }
    }
    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.4, 0.003);
}

} // namespace
} // namespace raycontact::test
