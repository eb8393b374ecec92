// SPDX-License-Identifier: Apache-2.0
// What a sleeping world costs in Bullet, which asks for the box of every body in every step: 1 000 bodies of one mesh
// that sleep on a floor, each shape that a mesh can have. Prints the medians of steps in microseconds, the least of all
// rounds, by turns.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

namespace raycontact::bench {

namespace {

constexpr int bodies = 1000, steps = 200;
enum class Kind { vertices, box, gimpact };
constexpr Kind kinds[] = {Kind::vertices, Kind::box, Kind::gimpact};

std::unique_ptr<btCollisionShape> make_shape(Kind kind, const std::shared_ptr<const Shape>& mesh,
                                             btTriangleMesh& triangles) {
    if (kind == Kind::vertices) return std::make_unique<bullet::MeshShape>(mesh);
    if (kind == Kind::box) return std::make_unique<bullet::MeshShape>(mesh, bullet::Bounds::box);
    auto shape = std::make_unique<btGImpactMeshShape>(&triangles);
    shape->updateBound();
    return shape;
}

/// Microseconds of a step.
double run(Kind kind, const std::shared_ptr<const Shape>& mesh, btTriangleMesh& triangles) {
    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    const auto shape = make_shape(kind, mesh, triangles);
    std::vector<std::unique_ptr<btRigidBody>> all;
    for (int i = 0; i < bodies; ++i) {
        const int column = i % 10, row = i / 10 % 10, layer = i / 100;
        btTransform pose(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(i)),
                         btVector3(btScalar(2 * column), btScalar(2 * row), btScalar(2 * layer)));
        all.push_back(std::make_unique<btRigidBody>(
            btRigidBody::btRigidBodyConstructionInfo(1, nullptr, shape.get(), btVector3(1, 1, 1))));
        all.back()->setWorldTransform(pose);
        all.back()->setInterpolationWorldTransform(pose);
        world.addRigidBody(all.back().get());
        all.back()->forceActivationState(ISLAND_SLEEPING);
    }
    std::vector<double> times;
    for (int i = 0; i < steps; ++i) {
        const double begin = peers::now().wall;
        world.stepSimulation(btScalar(1.0 / 60), 0);
        times.push_back(peers::now().wall - begin);
    }
    for (const auto& body : all) world.removeRigidBody(body.get());
    return peers::median(times);
}

void run_all(int rounds) {
    std::printf("%s\n%d sleeping bodies; least of %d medians, microseconds a step\n",
                heading(report::this_machine()).c_str(), bodies, rounds);
    std::printf("%9s  %10s %10s %10s\n", "triangles", "MeshShape", "and a box", "GImpact");
    for (const std::uint32_t triangles : {600u, 2000u, 20000u}) {
        const Mesh mesh = scenes::scene_model("torus", triangles).mesh;
        btTriangleMesh for_gimpact;
        const auto corner = [&](std::uint32_t v) {
            const Vec3& p = mesh.vertices[v];
            return btVector3(btScalar(p.x), btScalar(p.y), btScalar(p.z));
        };
        for (const auto& [a, b, c] : mesh.triangles) for_gimpact.addTriangle(corner(a), corner(b), corner(c));
        const auto shape = Shape::make(mesh);
        double least[std::size(kinds)] = {1e30, 1e30, 1e30};
        for (int round = 0; round < rounds; ++round)
            for (std::size_t k = 0; k < std::size(kinds); ++k)
                least[k] = std::min(least[k], run(kinds[k], shape, for_gimpact));
        std::printf("%9zu  %10.0f %10.0f %10.0f\n", mesh.triangles.size(), least[0], least[1], least[2]);
        std::fflush(stdout);
    }
}

} // namespace

void add_sleeping(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("sleeping", "What a sleeping world costs in Bullet: MeshShape with either bounds, GImpact");
    auto rounds = std::make_shared<int>(5);
    add_number(*command, "--rounds", *rounds, "by turns; the least counts", 1, 1000);
    command->callback([rounds] { run_all(*rounds); });
}

} // namespace raycontact::bench
