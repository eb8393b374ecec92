// SPDX-License-Identifier: Apache-2.0
// The hash of a small fixed scene, stored here: procedural meshes, no libm, so one number for every machine.
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

struct Result {
    std::string hash;
    std::uint64_t contacts = 0, rays = 0;
};

Result run(const Settings& settings, const std::vector<Mesh>& meshes, double spread, std::uint32_t steps) {
    Scene scene(settings);
    Random random(2013);
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < 24; ++i) {
        Pose pose = random.rotation();
        pose.translation = spread * random.in_ball();
        scene.add(Shape::make(meshes[i % meshes.size()]), pose);
        poses.push_back(pose);
    }
    Result result;
    ContactHash hash(settings.direction);
    for (std::uint32_t step = 0; step < steps; ++step) {
        const auto contacts = scene.find_contacts();
        hash.add(step, contacts);
        result.contacts += contacts.size();
        result.rays += scene.stats().details.rays;
        for (std::uint32_t body = 0; body < poses.size(); ++body) {
            poses[body].translation = poses[body].translation + 0.02 * random.in_ball();
            scene.set_pose({body}, poses[body]);
        }
    }
    result.hash = hash.hex();
    return result;
}

void expect_golden(const std::vector<Mesh>& meshes, double spread, std::uint32_t steps, const char* golden,
                   std::uint64_t contacts, Direction direction = Direction::reprojected,
                   Features features = Features::vertices) {
    for (const Method method : {Method::standard, Method::certified})
        for (const Caster caster : {Caster::bvh, Caster::basic})
            for (const std::uint32_t threads : {1u, 2u, 3u}) {
                Settings settings;
                settings.features = features;
                settings.method = method;
                settings.direction = direction;
                settings.paper.caster = caster;
                settings.execution.threads = threads;
                const Result result = run(settings, meshes, spread, steps);
                if (caster == Caster::bvh && threads == 1)
                    std::printf("[ counts   ] %s, %u steps, %llu rays, %llu contacts, hash %s\n",
                                std::string(to_string(method)).c_str(), steps,
                                static_cast<unsigned long long>(result.rays),
                                static_cast<unsigned long long>(result.contacts), result.hash.c_str());
                EXPECT_EQ(result.hash, golden) << to_string(method) << ", " << to_string(caster) << ", " << threads;
                EXPECT_EQ(result.contacts, contacts) << to_string(method) << ", " << to_string(caster);
            }
}

// The meshes of this folder alone: a change here is a change of the library.
TEST(golden, plain_meshes) {
    expect_golden({bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(), bowl_mesh(8)}, 1.5, 6,
                  "0cd9da44f0afd8ec", 7737);
}

// The contacts of the test above, with normals along the rays, and with weights.
TEST(golden, directions_of_plain_meshes) {
    const std::vector<Mesh> meshes{bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(),
                                   bowl_mesh(8)};
    expect_golden(meshes, 1.5, 6, "06b09c883d9d859b", 7737, Direction::ray);
    expect_golden(meshes, 1.5, 6, "5033be61d7b69a6f", 7737, Direction::weighted);
}

// The same meshes, with edges.
TEST(golden, edges_of_plain_meshes) {
    expect_golden({bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(), bowl_mesh(8)}, 1.5, 6,
                  "e9a63f6733bfd147", 8260, Direction::reprojected, Features::edges);
}

// The procedural meshes of the scenes: changes with them too.
TEST(golden, scene_meshes) {
    expect_golden({model_mesh("knot"), model_mesh("gear"), model_mesh("torus"), model_mesh("sphere")}, 1.0, 6,
                  "6dfe79694fded8b4", 29694);
}

} // namespace
