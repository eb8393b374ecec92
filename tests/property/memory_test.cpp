// SPDX-License-Identifier: Apache-2.0
// What the process takes for pairs, as the system counts it: at most twice what is stated, and given back.
#include "prepared_shape.h"
#include "scenes/models/model.h"

#include <raycontact/scene.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace raycontact {
namespace {

constexpr std::int64_t mega = 1 << 20;

std::int64_t resident() {
    std::int64_t all = 0, there = 0;
    std::ifstream("/proc/self/statm") >> all >> there;
    return there * sysconf(_SC_PAGESIZE);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif
#else
constexpr bool sanitized = false;
#endif
constexpr const char* why_skipped = "a sanitizer keeps what was freed, so what is resident says nothing";

std::shared_ptr<const Shape> tetrahedron() {
    Mesh mesh;
    mesh.name = "tetrahedron";
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return prepared_shape(mesh);
}

// All in one place, but for some millimetres; or each by itself.
void place(Scene& scene, bool together) {
    for (std::uint32_t i = 0; i < scene.body_count(); ++i) {
        const double place = together ? 0.001 : 10;
        const std::uint32_t column = i % 10, row = i / 10 % 10, layer = i / 100;
        scene.set_pose({i}, {.translation = {place * column, place * row, place * layer}});
    }
}

void expect_memory_follows(Method method, Features features = Features::vertices, std::uint32_t bodies = 600) {
    if (sanitized) GTEST_SKIP() << why_skipped;
    Settings settings;
    settings.method = method;
    settings.features = features;
    settings.execution.devices = "cpu";
    settings.execution.threads = 1;
    Scene scene(settings);
    const auto shape = tetrahedron();
    for (std::uint32_t i = 0; i < bodies; ++i) scene.add(shape);
    place(scene, false);
    scene.find_contacts();
    const std::int64_t before = resident();
    for (int round = 0; round < 3; ++round) {
        std::int64_t stated = 0, most = 0;
        place(scene, true);
        for (int step = 0; step < 4; ++step) {
            scene.find_contacts();
            ASSERT_EQ(scene.stats().pairs, bodies * (bodies - 1) / 2);
            stated = std::max(stated, static_cast<std::int64_t>(scene.stats().pair_bytes));
            most = std::max(most, resident() - before);
            EXPECT_LE(resident() - before, 2 * static_cast<std::int64_t>(scene.stats().pair_bytes) + 32 * mega)
                << to_string(method) << ", step " << step;
        }
        if (round == 0)
            std::printf("[ memory   ] %s, %s, %u pairs: %.0f MB resident, %.0f stated\n",
                        std::string(to_string(method)).c_str(), std::string(to_string(features)).c_str(),
                        bodies * (bodies - 1) / 2, static_cast<double>(most) / 1e6, static_cast<double>(stated) / 1e6);
        EXPECT_GT(scene.stats().contacts, 10000u);
        EXPECT_LE(most, 2 * stated) << to_string(method);
        EXPECT_GT(most, 32 * mega) << "else nothing is seen to be given back";
        place(scene, false);
        for (int step = 0; step < 2; ++step) scene.find_contacts();
        EXPECT_LE(resident() - before, std::max(most / 8, 8 * mega)) << to_string(method) << ", round " << round;
    }
}

TEST(Memory, FollowsThePairsOfCertified) {
    expect_memory_follows(Method::certified);
}

TEST(Memory, FollowsThePairsOfEdges) {
    expect_memory_follows(Method::certified, Features::edges, 360); // 64 620 pairs, most of them with edges that cross
}

TEST(Memory, FollowsThePairsOfStandard) {
    expect_memory_follows(Method::standard);
}

TEST(Memory, FollowsThePairsOfIterative) {
    expect_memory_follows(Method::iterative);
}

TEST(Memory, FollowsThePairsOfPredictive) {
    expect_memory_follows(Method::predictive);
}

// Two thousand shapes of a third of a megabyte each, of which one is in use at a time, and no step.
TEST(Memory, OfShapesThatNoBodyUsesIsGivenBackWithoutAStep) {
    if (sanitized) GTEST_SKIP() << why_skipped;
    const std::shared_ptr<const Shape> shapes[] = {prepared_shape(scenes::scene_model("knot", 902).mesh),
                                                   prepared_shape(scenes::scene_model("gear", 902).mesh)};
    Settings settings;
    settings.execution.devices = "cpu";
    settings.execution.threads = 1;
    Scene scene(settings);
    const BodyId stays = scene.add(tetrahedron());
    const std::int64_t before = resident();
    for (std::size_t i = 0; i < 2000; ++i) {
        const BodyId guest = scene.add(shapes[i % 2]);
        scene.remove(guest);
    }
    EXPECT_LE(resident() - before, 32 * mega);
    // And those that stay are what they were.
    const BodyId other = scene.add(shapes[0], {.translation = {0.3, 0, 0}});
    const auto found = scene.find_contacts(std::vector<Pair>{{stays, other}});
    Scene fresh(settings);
    fresh.add(tetrahedron());
    fresh.add(shapes[0], {.translation = {0.3, 0, 0}});
    const auto expected = fresh.find_contacts();
    ASSERT_GT(expected.size(), 0u);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].key(), expected[i].key());
}

} // namespace
} // namespace raycontact
