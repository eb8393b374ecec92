// SPDX-License-Identifier: Apache-2.0
// How many launches and waits a step takes. A ceiling rises only with what a step does more.
#include "property/shapes.h"
#include "reference/random.h"
#include "reference/vector.h"

#include <raycontact/scene.h>

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;

struct Ceiling {
    Method method;
    std::uint64_t launches, reads; ///< of the median step
    Features features = Features::vertices;
};

constexpr Ceiling ceilings[] = {{Method::standard, 11, 1},
                                {Method::certified, 16, 4},
                                {Method::iterative, 14, 1},
                                {Method::predictive, 14, 1},
                                // Edges are read with the contacts of vertices. Three launches more than at first
                                // tell which pairs may be inside one another: the host asked all of them.
                                {Method::standard, 24, 1, Features::edges},
                                {Method::iterative, 29, 1, Features::edges},
                                {Method::predictive, 29, 1, Features::edges},
                                {Method::certified, 26, 5, Features::edges}};

std::uint64_t median(std::vector<std::uint64_t> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Bodies of all kinds in a ball.
std::vector<Pose> add_crowd(Scene& scene, Random& random, std::uint32_t count, double radius) {
    const auto& subjects = closed_subjects();
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < count; ++i) {
        Pose pose = random.rotation();
        pose.translation = radius * random.in_ball();
        scene.add(subjects[i % subjects.size()].shape, pose);
        poses.push_back(pose);
    }
    return poses;
}

// A crowd in which most bodies creep, some are fast, and pairs come and go in every step.
TEST(ceilings, launches_and_reads_of_a_step) {
    for (const Ceiling& ceiling : ceilings) {
        Settings settings;
        settings.method = ceiling.method;
        settings.features = ceiling.features;
        settings.execution.devices = "cpu";
        settings.execution.threads = 1;
        Scene scene(settings);
        Random random(21);
        std::vector<Pose> poses = add_crowd(scene, random, 60, 1.9);
        std::vector<std::uint64_t> launches, reads;
        for (int step = 0; step < 60; ++step) {
            EXPECT_GT(scene.find_contacts().size(), 100u);
            const StepStats& stats = scene.stats();
            ASSERT_EQ(stats.details.work.size(), 1u);
            EXPECT_EQ(stats.details.work[0].device, "cpu");
            EXPECT_EQ(stats.details.work[0].pairs, stats.pairs);
            EXPECT_GT(stats.details.work[0].bytes_down, 0u);
            EXPECT_GT(stats.details.work[0].busy_ms, 0);
            launches.push_back(stats.details.work[0].launches);
            reads.push_back(stats.details.work[0].reads);
            for (std::uint32_t body = 0; body < poses.size(); ++body) {
                const double pace = body % 6 == 0 ? 0.02 : 0.0005;
                poses[body].translation = poses[body].translation + pace * random.in_ball();
                scene.set_pose({body}, poses[body]);
            }
        }
        EXPECT_LE(median(launches), ceiling.launches) << to_string(ceiling.method);
        EXPECT_LE(median(reads), ceiling.reads) << to_string(ceiling.method);
    }
}

// Bodies that draw closer: each step needs more room than the one before, and few of them find too little.
TEST(ceilings, a_growing_heap_seldom_repeats_a_step) {
    Settings settings;
    settings.method = Method::standard;
    settings.execution.threads = 1;
    Scene scene(settings);
    Random random(22);
    std::vector<Pose> poses = add_crowd(scene, random, 400, 6.0);
    std::vector<std::uint64_t> reads;
    for (int step = 0; step < 40; ++step) {
        scene.find_contacts();
        reads.push_back(scene.stats().details.work[0].reads);
        for (std::uint32_t body = 0; body < poses.size(); ++body) {
            poses[body].translation = 0.98 * poses[body].translation;
            scene.set_pose({body}, poses[body]);
        }
    }
    EXPECT_GT(scene.stats().details.vertices, 4 * 16 * 4096u); // the first room has been outgrown
    EXPECT_EQ(median(reads), 1u);                              // one more for each repetition
}

} // namespace
} // namespace raycontact
