// SPDX-License-Identifier: Apache-2.0
// What each of the recommended settings is for: run it to see the figures of docs/solver.md.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>
#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>

namespace raycontact::test {
namespace {

using Change = std::function<void(btContactSolverInfo&)>;

/// A world with Bullet's own settings, then changed.
void set_up(TestWorld& w, const Change& change) {
    w.world.getSolverInfo() = btContactSolverInfo();
    change(w.world.getSolverInfo());
}

std::shared_ptr<const Shape> bunny() {
    static const auto shape = Shape::make(scenes::scene_model("bunny", 900).mesh);
    return shape;
}

/// Millimetres by which a bunny goes to and fro that twice its weight presses against a wall, in the second after
/// three.
double shake_at_a_wall(const Change& change) {
    TestWorld w;
    set_up(w, change);
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

struct Pile {
    double speed = 0;   ///< median of all bodies over the last second, mm/s
    double deepest = 0; ///< mm, in that second
};

/// 48 bunnies that fell on a slab, after ten seconds.
Pile pile(const Change& change) {
    TestWorld w;
    set_up(w, change);
    w.add_mesh(Shape::make(box_mesh(20, 20, 1)), 0, at(0, 0, -0.5));
    for (int i = 0; i < 48; ++i) {
        const int layer = i / 4, row = i / 2 % 2;
        btTransform pose = at(0.5 * (i % 2) - 0.25, 0.5 * row - 0.25, 0.6 + 0.7 * layer);
        pose.setRotation(btQuaternion(btVector3(1, 2, btScalar(i)).normalized(), btScalar(i)));
        w.add_mesh(bunny(), 5, pose);
    }
    w.steps(540);
    Pile found;
    std::vector<double> speeds;
    for (int i = 0; i < 60; ++i) {
        w.steps(1);
        found.deepest = std::max(found.deepest, 1000 * w.dispatcher.scene().stats().depth_max);
        for (const auto& body : w.bodies)
            if (!body->isStaticObject()) speeds.push_back(1000 * double(body->getLinearVelocity().length()));
    }
    std::nth_element(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2), speeds.end());
    found.speed = speeds[speeds.size() / 2];
    return found;
}

TEST(Recommend, MeshesComeToRest) {
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
    const std::pair<const char*, Change> rows[] = {
        {"Bullet's own", [](btContactSolverInfo&) {}},
        {"recommended", recommended},
        {"  but slop 0", but([&](btContactSolverInfo& info) { info.m_linearSlop = own.m_linearSlop; })},
        {"  but erp2 0.2", but([&](btContactSolverInfo& info) { info.m_erp2 = own.m_erp2; })},
        {"  but split impulses from 40 mm on", but([&](btContactSolverInfo& info) {
             info.m_splitImpulsePenetrationThreshold = own.m_splitImpulsePenetrationThreshold;
         })},
        {"  but 10 iterations", but([&](btContactSolverInfo& info) { info.m_numIterations = own.m_numIterations; })},
        {"  but one direction of friction",
         but([&](btContactSolverInfo& info) { info.m_solverMode = own.m_solverMode; })},
        {"Bullet's own but slop 0.001", [](btContactSolverInfo& info) { info.m_linearSlop = btScalar(0.001); }},
    };
    std::vector<double> shakes, speeds;
    for (const auto& [name, change] : rows) {
        const double shake = shake_at_a_wall(change);
        const Pile heap = pile(change);
        std::printf("[ counts ] %-36s shakes at a wall by %7.3f mm; a pile's median speed %6.2f mm/s, %5.1f mm deep\n",
                    name, shake, heap.speed, heap.deepest);
        shakes.push_back(shake);
        speeds.push_back(heap.speed);
    }
    EXPECT_LT(shakes[1], 0.2);
    EXPECT_LT(shakes[1], shakes[0] / 5);
    EXPECT_LT(speeds[1], speeds[0] / 2);
}

} // namespace
} // namespace raycontact::test
