// SPDX-License-Identifier: Apache-2.0
// What a floor costs in Bullet: 144 bodies of a mesh dropped on a plane, a mesh of 12 triangles, a btBoxShape that is
// ours, and one that is left to Bullet. Prints medians of the last three seconds of five, in milliseconds.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>
#include <scenes/models/machined.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>
#include <scenes/random.h>
#include <tests/stacks/solids.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::bench {

namespace {

constexpr int side = 12;        ///< bodies in a row
constexpr double spacing = 1.5; // metres
constexpr int steps = 300, measured = 180;

enum class Ground { plane, slab, box, bullets_box };
constexpr Ground grounds[] = {Ground::plane, Ground::slab, Ground::box, Ground::bullets_box};
constexpr const char* names[] = {"plane", "slab", "box", "box (Bullet)"};

/// Times the detection within each step.
struct World : btDiscreteDynamicsWorld {
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
    double detection_ms = 0;
    void performDiscreteCollisionDetection() override {
        const double begin = peers::now().wall;
        btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
        detection_ms = 1e-3 * (peers::now().wall - begin);
    }
};

struct Times {
    double step = 1e30, detection = 1e30; ///< the least of all rounds
    std::uint64_t contacts = 0;
    double lowest = 0; ///< of the bodies' origins at the end: nothing fell through
};

void run(const std::shared_ptr<const Shape>& mesh, Ground ground, bool slide, Times& times) {
    btDefaultCollisionConfiguration configuration;
    Settings settings;
    settings.execution.threads = 1;
    bullet::CollisionDispatcher dispatcher(&configuration, settings, {},
                                           ground == Ground::bullets_box ? bullet::ConvexShapes::bullet
                                                                         : bullet::ConvexShapes::ours);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    World world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    world.getSolverInfo().m_linearSlop = btScalar(0.002);

    std::unique_ptr<btCollisionShape> floor;
    if (ground == Ground::plane)
        floor = std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0.5));
    else if (ground == Ground::slab)
        floor = std::make_unique<bullet::MeshShape>(Shape::make(scenes::solid_box({20, 20, 1})));
    else
        floor = std::make_unique<btBoxShape>(btVector3(10, 10, btScalar(0.5)));
    bullet::MeshShape shape(mesh);
    btVector3 inertia;
    shape.calculateLocalInertia(1, inertia);
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    const auto add = [&](btCollisionShape& s, btScalar mass, const btTransform& pose) {
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &s, inertia);
        info.m_startWorldTransform = pose;
        info.m_friction = btScalar(slide ? 0 : 0.8);
        bodies.push_back(std::make_unique<btRigidBody>(info));
        bodies.back()->setActivationState(DISABLE_DEACTIVATION);
        world.addRigidBody(bodies.back().get());
    };
    add(*floor, 0, btTransform(btQuaternion::getIdentity(), btVector3(0, 0, btScalar(-0.5))));
    scenes::Random random(1);
    for (int i = 0; i < side; ++i)
        for (int k = 0; k < side; ++k) {
            const auto tilt = random.tilt(0.3);
            const btQuaternion turn{btScalar(tilt[1]), btScalar(tilt[2]), btScalar(tilt[3]), btScalar(tilt[0])};
            add(shape, 1,
                btTransform(turn, btVector3(btScalar(spacing * (i - (side - 1) / 2.0)),
                                            btScalar(spacing * (k - (side - 1) / 2.0)), btScalar(mesh->radius()))));
            if (slide) bodies.back()->setLinearVelocity(btVector3(btScalar(0.25), 0, 0));
        }

    std::vector<double> step_ms, detection_ms;
    for (int i = 0; i < steps; ++i) {
        const double begin = peers::now().wall;
        world.stepSimulation(btScalar(1.0 / 60), 0);
        if (i < steps - measured) continue;
        step_ms.push_back(1e-3 * (peers::now().wall - begin));
        detection_ms.push_back(world.detection_ms);
    }
    times.step = std::min(times.step, median(step_ms));
    times.detection = std::min(times.detection, median(detection_ms));
    times.contacts = dispatcher.stats().contacts;
    times.lowest = 1e30;
    for (std::size_t i = 1; i < bodies.size(); ++i)
        times.lowest = std::min(times.lowest, double(bodies[i]->getWorldTransform().getOrigin().z()));
    for (const auto& body : bodies) world.removeRigidBody(body.get());
}

std::shared_ptr<const Shape> torus(std::uint32_t triangles) {
    Mesh mesh = scenes::scene_model("torus", triangles).mesh;
    return Shape::make(mesh);
}

void run_all(int rounds, bool slide) {
    const std::pair<const char*, std::shared_ptr<const Shape>> meshes[] = {
        {"box, 12 triangles", Shape::make(scenes::solid_box({0.8, 0.6, 0.4}))},
        {"tray, 28 triangles", Shape::make(scenes::solid_tray({0.8, 0.6, 0.4}, 0.05))},
        {"torus, 600 triangles", torus(600)},
        {"torus, 2400 triangles", torus(2400)}};
    std::printf("%s\n%d bodies%s; least of %d medians\n", heading(report::this_machine()).c_str(), side * side,
                slide ? ", sliding" : "", rounds);
    std::printf("%-22s %-13s %9s %12s %9s %9s\n", "bodies", "floor", "step ms", "detection ms", "contacts", "lowest m");
    for (const auto& [name, mesh] : meshes) {
        Times times[std::size(grounds)];
        for (int round = 0; round < rounds; ++round)
            for (std::size_t g = 0; g < std::size(grounds); ++g) run(mesh, grounds[g], slide, times[g]);
        for (std::size_t g = 0; g < std::size(grounds); ++g)
            std::printf("%-22s %-13s %9.3f %12.3f %9llu %9.3f\n", name, names[g], times[g].step, times[g].detection,
                        static_cast<unsigned long long>(times[g].contacts), times[g].lowest);
        std::fflush(stdout);
    }
}

} // namespace

void add_floor(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("floor", "What a floor costs in Bullet: a plane, a mesh of 12 triangles, a btBoxShape");
    auto rounds = std::make_shared<int>(3);
    auto slide = std::make_shared<bool>(false);
    add_number(*command, "--rounds", *rounds, "the grounds by turns, so many times", 1, 1000);
    command->add_flag("--slide", *slide, "bodies that slide for ever, without friction");
    command->callback([rounds, slide] { run_all(*rounds, *slide); });
}

} // namespace raycontact::bench
