// SPDX-License-Identifier: Apache-2.0
// A flag ends what a thread computes, and nothing is left halfway.
#include <raycontact/interruption.h>

#include "device/same_contacts.h"
#include "scenes/models/model.h"
#include "temporary_folder.h"

#include <raycontact/clash.h>
#include <raycontact/query.h>
#include <raycontact/scene.h>

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <random>
#include <sstream>
#include <thread>

namespace raycontact {
namespace {

using namespace std::chrono_literals;

Mesh knot(std::uint32_t triangles = 902) {
    return scenes::scene_model("knot", triangles).mesh;
}

std::string obj_of(const Mesh& mesh) {
    std::ostringstream text;
    for (const Vec3& v : mesh.vertices) text << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    for (const auto& [a, b, c] : mesh.triangles) text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
    return text.str();
}

TEST(Interruption, EndsEveryCall) {
    const TemporaryFolder folder;
    const Mesh mesh = knot();
    const auto file = folder.write("knot.obj", obj_of(mesh));
    const auto shape = Shape::make(mesh);
    const auto raw = std::make_shared<const Mesh>(mesh);
    const Pose near{.translation = {0.1, 0, 0}}, apart{.translation = {3, 0, 0}};
    const std::vector<AssemblyPart> parts{{"a", raw, {}}, {"b", raw, near}};
    Scene scene;
    scene.add(shape);
    scene.add(shape, near);
    const std::vector<std::pair<const char*, std::function<void()>>> calls{
        {"load_mesh", [&] { static_cast<void>(load_mesh(file)); }},
        {"load_parts",
         [&] {
             static_cast<void>(load_parts({file, file}));
         }},
        {"weld_mesh", [&] { static_cast<void>(weld_mesh(mesh, 1e-6)); }},
        {"prepare_mesh", [&] { static_cast<void>(prepare_mesh(mesh)); }},
        {"Shape::make", [&] { Shape::make(mesh); }},
        {"Shape::make of a prepared one",
         [&, prepared = prepare_mesh(mesh)] { static_cast<void>(Shape::make(prepared)); }},
        {"prepare", [&] { Shape::make(mesh)->prepare(); }},
        {"intersects", [&] { static_cast<void>(intersects(*shape, {}, *shape, near)); }},
        {"distance", [&] { static_cast<void>(distance(*shape, {}, *shape, apart)); }},
        {"closest_point",
         [&] {
             static_cast<void>(closest_point(*shape, {}, {2, 0, 0}));
         }},
        {"contains",
         [&] {
             static_cast<void>(contains(*shape, {0.1, 0.1, 0.1}));
         }},
        {"overlap_volume", [&] { static_cast<void>(overlap_volume(*shape, {}, *shape, near)); }},
        {"find_clashes", [&] { static_cast<void>(find_clashes(parts)); }},
        {"find_contacts", [&] { static_cast<void>(scene.find_contacts()); }},
    };
    std::atomic<bool> flag = true;
    for (const auto& [name, call] : calls) {
        {
            const Interruptible interruptible(&flag);
            EXPECT_THROW(call(), Interrupted) << name;
            const Interruptible to_its_end(nullptr);
            EXPECT_NO_THROW(call()) << name;
        }
        EXPECT_NO_THROW(call()) << name;
    }
}

// The flag counts on the threads of the call, and on no others.
TEST(Interruption, CountsForTheCallsOfOneThread) {
    const Mesh mesh = knot(20'000);
    std::atomic<bool> flag = true;
    std::thread other([&] { EXPECT_NO_THROW(Shape::make(mesh, 2)); });
    {
        const Interruptible interruptible(&flag);
        EXPECT_THROW(Shape::make(mesh, 2), Interrupted);
    }
    other.join();
}

// Steps that are ended anywhere, then asked for once more: their contacts are those of a scene that nobody interrupts.
TEST(Interruption, ASceneGoesOn) {
    const auto shape = Shape::make(knot());
    std::mt19937 random(1);
    std::size_t ended = 0, done = 0;
    for (const bool speculative : {false, true})
        for (const std::uint32_t threads : {1u, 3u}) {
            Settings settings;
            settings.speculative = speculative ? Speculative::on : Speculative::off;
            settings.execution.devices = "cpu";
            settings.execution.threads = threads;
            Scene scene(settings), calm(settings);
            std::vector<Pose> poses;
            std::vector<BodyId> bodies;
            for (int i = 0; i < 32; ++i) {
                poses.push_back({.translation = {0.5 * (i & 3), 0.5 * (i >> 2 & 3), 0.5 * (i >> 4)}});
                bodies.push_back(scene.add(shape, poses.back()));
                calm.add(shape, poses.back());
            }
            auto took = 2000us;
            for (int step = 0; step < 40; ++step) {
                std::uniform_real_distribution<double> move(-0.02, 0.02);
                for (Pose& pose : poses)
                    if (random() % 3 != 0)
                        pose.translation = {pose.translation.x + move(random), pose.translation.y + move(random),
                                            pose.translation.z};
                scene.set_poses(bodies, poses);
                calm.set_poses(bodies, poses);
                const auto start = std::chrono::steady_clock::now();
                const auto wanted = calm.find_contacts();
                took = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
                std::atomic<bool> flag = step % 8 == 0;
                const auto delay = took * static_cast<int>(random() % 100) / 100;
                std::thread watch([&] {
                    std::this_thread::sleep_for(delay);
                    flag = true;
                });
                try {
                    const Interruptible interruptible(&flag);
                    scene.find_contacts();
                    ++done;
                } catch (const Interrupted&) {
                    ++ended;
                    EXPECT_TRUE(scene.contacts().empty());
                    EXPECT_FALSE(scene.find_contacts().empty());
                }
                watch.join();
                ASSERT_TRUE(device_test::same(scene.contacts(), wanted)) << step << ", " << threads << " threads";
            }
        }
    EXPECT_GE(ended, 20u);
    std::cout << ended << " steps ended early, " << done << " came to their end\n";
}

} // namespace
} // namespace raycontact
