// SPDX-License-Identifier: Apache-2.0
// What `certified` learns of a new pair must not cost much more than a step of `standard`, however fine the meshes.
#include "scenes/models/model.h"

#include <raycontact/scene.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <gtest/gtest.h>
#include <vector>

namespace raycontact {
namespace {

constexpr int steps = 10;

double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

// The least of some runs for each step. Two bodies deep in each other, so that rays are long and many.
std::vector<double> least_ms(const std::shared_ptr<const Shape>& shape, Method method, double pace) {
    std::vector<double> least(steps, 1e300);
    for (int run = 0; run < 4; ++run) {
        Settings settings;
        settings.method = method;
        settings.features = Features::vertices;
        settings.devices = "cpu";
        settings.threads = 1;
        Scene scene(settings);
        const double size = shape->box_max().x - shape->box_min().x;
        scene.add(shape);
        const BodyId moving = scene.add(shape);
        for (int step = 0; step < steps; ++step) {
            const Vec3 at{size * (0.3 - 0.5 * pace * step), size * (0.05 + 0.5 * pace * step), 0};
            scene.set_pose(moving, pose_from_quaternion(at, 1, pace * step, 0, 0));
            const double start = processor_ms();
            scene.step();
            least[static_cast<std::size_t>(step)] =
                std::min(least[static_cast<std::size_t>(step)], processor_ms() - start);
        }
        EXPECT_GT(scene.contacts().size(), 100u);
    }
    return least;
}

TEST(FirstStep, OfCertifiedIsNoCliff) {
    for (const std::uint32_t triangles : {1'000u, 10'000u, 100'000u}) {
        const auto shape = Shape::make(scenes::scene_model("sphere", triangles).mesh);
        for (const double pace : {0.0, 0.001}) {
            const auto certified = least_ms(shape, Method::certified, pace);
            const auto standard = least_ms(shape, Method::standard, pace);
            std::printf("[ ratio    ] %u triangles, pace %g: %.2f in the first step\n", triangles, pace,
                        certified[0] / standard[0]);
            for (std::size_t step = 0; step < steps; ++step)
                EXPECT_LT(certified[step], 3 * standard[step]) << triangles << " triangles, step " << step;
        }
    }
}

} // namespace
} // namespace raycontact
