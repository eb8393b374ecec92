// SPDX-License-Identifier: Apache-2.0
// What each of the recommended settings is for: run it to see the figures of docs/internals/bullet-measurements.md.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>
#include <raycontact/error.h>
#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>

namespace raycontact::test {
namespace {

using Change = std::function<void(btContactSolverInfo&)>;

/// A world of `settings` with Bullet's own solver settings, then changed.
struct World : TestWorld {
    World(const Settings& settings, const Change& change) : TestWorld(settings) {
        world.getSolverInfo() = btContactSolverInfo();
        change(world.getSolverInfo());
    }
};

std::shared_ptr<const Shape> bunny() {
    static const auto shape = Shape::make(scenes::scene_model("bunny", 900).mesh);
    return shape;
}

/// Millimetres by which a bunny goes to and fro that twice its weight presses against a wall, in the second after
/// three.
double shake_at_a_wall(const Settings& settings, const Change& change) {
    World w(settings, change);
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    w.add_mesh(Shape::make(box_mesh(1, 6, 3)), 0, at(1.1, 0, 1.5));
    btRigidBody& body = w.add_mesh(bunny(), 5, at(0.05, 0.03, 0.42));
    body.setFriction(0);
    btScalar least = BT_LARGE_FLOAT, most = -BT_LARGE_FLOAT;
    for (int i = 0; i < 240; ++i) {
        body.applyCentralForce(btVector3(btScalar(2 * 5 * 9.81), 0, 0));
        w.steps(1);
        if (i < 180) continue;
        least = btMin(least, body.getWorldTransform().getOrigin().x());
        most = btMax(most, body.getWorldTransform().getOrigin().x());
    }
    return 1000 * double(most - least);
}

/// Millimetres a second at which a table flies off that began 20 mm deep in a slab, without gravity.
double flies_off(const Settings& settings, const Change& change) {
    World w(settings, change);
    w.world.setGravity(btVector3(0, 0, 0));
    w.add_mesh(Shape::make(box_mesh(6, 6, 1)), 0, at(0, 0, -0.5));
    const btRigidBody& body = w.add_mesh(table(), 5, at(0, 0, 0.38));
    w.steps(60);
    return 1000 * double(body.getLinearVelocity().length());
}

struct Piles {
    double speed = 0;   ///< median of all bodies over the last second, mm/s
    double deepest = 0; ///< mm, median of the steps of that second
};

double median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

/// Eight heaps of eight bunnies that fell on a slab, in the fifth second: each is one draw of many.
Piles piles(const Settings& settings, const Change& change) {
    std::vector<double> speeds, depths;
    for (int heap = 0; heap < 8; ++heap) {
        World w(settings, change);
        w.add_mesh(Shape::make(box_mesh(20, 20, 1)), 0, at(0, 0, -0.5));
        for (int i = 0; i < 8; ++i) {
            const int layer = i / 4, row = i / 2 % 2;
            btTransform pose = at(0.5 * (i % 2) - 0.25, 0.5 * row - 0.25, 0.6 + 0.7 * layer);
            pose.setRotation(btQuaternion(btVector3(1, 2, btScalar(i)).normalized(), btScalar(i + 50 * heap)));
            w.add_mesh(bunny(), 5, pose);
        }
        w.steps(240);
        for (int i = 0; i < 60; ++i) {
            w.steps(1);
            depths.push_back(1000 * w.dispatcher.scene().stats().depth_max);
            for (const auto& body : w.bodies)
                if (!body->isStaticObject()) speeds.push_back(1000 * double(body->getLinearVelocity().length()));
        }
    }
    return {median(speeds), median(depths)};
}

struct Row {
    double shake, speed_off;
    Piles piles;
};

constexpr const char* names[] = {"Bullet's own",
                                 "recommended",
                                 "  but slop 0",
                                 "  but erp2 0.2",
                                 "  but split impulses from 40 mm on",
                                 "  but 10 iterations",
                                 "  but one direction of friction",
                                 "Bullet's own but slop 0.001",
                                 "recommended but warm starting 0.85"};

std::vector<Row> measure(const Settings& settings) {
    const auto recommended = [](btContactSolverInfo& info) {
        TestWorld w;
        w.world.getSolverInfo() = btContactSolverInfo();
        bullet::recommend(w.world);
        info = w.world.getSolverInfo();
    };
    const auto but = [&](const Change& change) {
        return [=](btContactSolverInfo& info) {
            recommended(info);
            change(info);
        };
    };
    const btContactSolverInfo own;
    const Change changes[] = {
        [](btContactSolverInfo&) {},
        recommended,
        but([&](btContactSolverInfo& info) { info.m_linearSlop = own.m_linearSlop; }),
        but([&](btContactSolverInfo& info) { info.m_erp2 = own.m_erp2; }),
        but([&](btContactSolverInfo& info) {
            info.m_splitImpulsePenetrationThreshold = own.m_splitImpulsePenetrationThreshold;
        }),
        but([&](btContactSolverInfo& info) { info.m_numIterations = own.m_numIterations; }),
        but([&](btContactSolverInfo& info) { info.m_solverMode = own.m_solverMode; }),
        [](btContactSolverInfo& info) { info.m_linearSlop = btScalar(0.001); },
        but([&](btContactSolverInfo& info) { info.m_warmstartingFactor = own.m_warmstartingFactor; }),
    };
    std::vector<Row> found;
    for (const Change& change : changes) {
        const Row row{shake_at_a_wall(settings, change), flies_off(settings, change), piles(settings, change)};
        std::printf(
            "[ counts ] %-36s shakes at a wall by %6.3f mm; flies off at %4.0f mm/s; piles' median speed %6.2f mm/s, "
            "%4.1f mm deep\n",
            names[found.size()], row.shake, row.speed_off, row.piles.speed, row.piles.deepest);
        found.push_back(row);
    }
    return found;
}

/// What each setting is there for, with speculative contacts and without.
void expect_rest(const std::vector<Row>& found) {
    const Row& best = found[1];
    EXPECT_LT(best.shake, 0.2);
    EXPECT_LT(best.speed_off, 10);
    for (const std::size_t row : {0, 5, 6}) EXPECT_LT(best.piles.speed, found[row].piles.speed) << names[row];
    EXPECT_GT(found[4].speed_off, 100);
    EXPECT_LT(found[7].shake, 0.2);
}

TEST(Recommend, MeshesComeToRest) {
    const std::vector<Row> found = measure({});
    expect_rest(found);
    // What is pushed out to the surface keeps its contact: nothing shakes, and no slop is needed.
    for (const Row& row : found) EXPECT_LT(row.shake, 0.01);
    EXPECT_LT(found[2].piles.speed, found[0].piles.speed / 2);
    EXPECT_LT(found[2].piles.deepest, 0.6 * found[1].piles.deepest);
    EXPECT_LT(found[1].piles.deepest, found[3].piles.deepest);
}

TEST(Recommend, MeshesComeToRestWithoutSpeculativeContacts) {
    Settings settings;
    settings.speculative = Speculative::off;
    const std::vector<Row> found = measure(settings);
    expect_rest(found);
    EXPECT_LT(found[1].shake, found[0].shake / 5);
    EXPECT_GT(found[2].shake, 0.5);
    EXPECT_LT(found[1].piles.speed, found[2].piles.speed / 2);
}

TEST(Recommend, TheSlopGoesByTheSmallestBodyThatMoves) {
    TestWorld w;
    const auto slop = [&](const bullet::SolverSettings& settings) {
        bullet::recommend(w.world, settings);
        return 1000 * double(w.world.getSolverInfo().m_linearSlop);
    };
    w.add_mesh(Shape::make(box_mesh(0.001, 0.001, 0.001)), 0, at(0, 0, -5));
    EXPECT_NEAR(slop({}), 1, 1e-6) << "nothing moves";
    w.add_mesh(table(), 5, at(0, 0, 1));
    EXPECT_NEAR(slop({}), 1, 0.01);
    w.add(std::make_unique<btSphereShape>(btScalar(0.05)), 1, at(2, 0, 1));
    EXPECT_NEAR(slop({}), 0.1, 0.01);
    auto nut = std::make_unique<btCompoundShape>();
    nut->addChildShape(at(0, 0, 0),
                       &w.keep(std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(0.02, 0.02, 0.01)))));
    w.add(std::move(nut), 1, at(4, 0, 1));
    EXPECT_NEAR(slop({}), 0.02, 0.005);
    EXPECT_NEAR(slop({.size = 0.5}), 0.5, 1e-6);
    EXPECT_NEAR(slop({.slop = 0.003, .size = 0.5}), 3, 1e-6);
    Settings without;
    without.speculative = Speculative::off;
    TestWorld other(without);
    bullet::recommend(other.world, {.size = 0.02});
    EXPECT_NEAR(1000 * double(other.world.getSolverInfo().m_linearSlop), 0.1, 1e-6);
}

// A body on a spring of 2000 N/m for each of its points, of the dispatcher's pairs and of Bullet's own.
TEST(Recommend, SoftContactsStaySoft) {
    struct Soft {
        const char* name;
        bool on_mesh;
        int points;
        std::function<std::unique_ptr<btCollisionShape>()> make;
    };
    const auto half = btScalar(0.1);
    const auto box = [&]() -> std::unique_ptr<btCollisionShape> {
        return std::make_unique<btBoxShape>(btVector3(half, half, half));
    };
    const auto ball = [&]() -> std::unique_ptr<btCollisionShape> { return std::make_unique<btSphereShape>(half); };
    const auto mesh = [&]() -> std::unique_ptr<btCollisionShape> {
        return std::make_unique<bullet::MeshShape>(Shape::make(box_mesh(0.2, 0.2, 0.2)));
    };
    const Soft cases[] = {{"mesh", true, 4, mesh},
                          {"ball on a mesh", true, 1, ball},
                          {"box on a mesh", true, 4, box},
                          {"ball on a box", false, 1, ball},
                          {"box on a box", false, 4, box}};
    for (const Soft& c : cases)
        for (const int hertz : {60, 240})
            for (const double damping : {20.0, 200.0}) {
                TestWorld w;
                btRigidBody& ground =
                    c.on_mesh ? w.add_mesh(Shape::make(box_mesh(4, 4, 1)), 0, at(0, 0, -0.5))
                              : w.add(std::make_unique<btBoxShape>(btVector3(2, 2, btScalar(0.5))), 0, at(0, 0, -0.5));
                btRigidBody& body = w.add(c.make(), 1, at(0.03, 0.02, 0.1));
                bullet::recommend(w.world);
                body.setContactStiffnessAndDamping(2000, btScalar(damping));
                ground.setContactStiffnessAndDamping(btScalar(1e18), btScalar(0.1));
                for (int i = 0; i < 5 * hertz; ++i) w.world.stepSimulation(btScalar(1.0 / hertz), 0);
                const double right = 9.81 / 2000 / c.points,
                             sunk = 0.1 - double(body.getWorldTransform().getOrigin().z());
                EXPECT_NEAR(sunk, right, 0.02 * right) << c.name << ' ' << hertz << ' ' << damping;
                EXPECT_LT(double(body.getLinearVelocity().length()), 1e-3) << c.name << ' ' << hertz << ' ' << damping;
                // Asleep and awake again it lies as deep.
                body.forceActivationState(ISLAND_SLEEPING);
                w.steps(5);
                body.forceActivationState(DISABLE_DEACTIVATION);
                for (int i = 0; i < hertz; ++i) w.world.stepSimulation(btScalar(1.0 / hertz), 0);
                EXPECT_NEAR(0.1 - double(body.getWorldTransform().getOrigin().z()), right, 0.02 * right) << c.name;
            }
}

TEST(Recommend, RefusesWhatIsOutOfRange) {
    TestWorld w;
    const btContactSolverInfo before = w.world.getSolverInfo();
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    using Bad = bullet::SolverSettings;
    for (const Bad& bad :
         {Bad{.slop = -1e-9}, Bad{.slop = nan}, Bad{.slop = inf}, Bad{.size = 0}, Bad{.size = nan}, Bad{.erp = -0.1},
          Bad{.erp = 1.1}, Bad{.erp = nan}, Bad{.iterations = 0}, Bad{.iterations = -3}})
        EXPECT_THROW(bullet::recommend(w.world, bad), InputError);
    EXPECT_EQ(w.world.getSolverInfo().m_linearSlop, before.m_linearSlop);
    EXPECT_NO_THROW(bullet::recommend(w.world, {.slop = 0, .erp = 1, .iterations = 1}));
    EXPECT_EQ(w.world.getSolverInfo().m_numIterations, 1);
}

} // namespace
} // namespace raycontact::test
