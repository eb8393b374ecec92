// SPDX-License-Identifier: Apache-2.0
// What `certified` learns of a new pair must not cost much more than a step of `standard`, however fine the meshes.
// Rays are counted; what else it does takes a time, which the long tier measures.
#include "scenes/models/model.h"
#include "time_limit.h"

#include <raycontact/scene.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
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

struct Cost {
    std::vector<double> ms = std::vector<double>(steps, 1e300);          ///< of each step, the least of some runs
    std::vector<std::uint64_t> rays = std::vector<std::uint64_t>(steps); ///< cast in each step
    std::uint64_t as_standard = 0;                                       ///< of the last step
};

// Two bodies deep in each other, so that rays are long and many.
Cost cost_of(const std::shared_ptr<const Shape>& shape, Method method, double pace) {
    Cost cost;
    for (int run = 0; run < 4; ++run) {
        Settings settings;
        settings.method = method;
        settings.features = Features::vertices;
        settings.execution.devices = "cpu";
        settings.execution.threads = 1;
        Scene scene(settings);
        const double size = shape->box_max().x - shape->box_min().x;
        scene.add(shape);
        const BodyId moving = scene.add(shape);
        for (int step = 0; step < steps; ++step) {
            const Vec3 at{size * (0.3 - 0.5 * pace * step), size * (0.05 + 0.5 * pace * step), 0};
            scene.set_pose(moving, pose_from_quaternion(at, 1, pace * step, 0, 0));
            const double start = processor_ms();
            scene.find_contacts();
            double& least = cost.ms[static_cast<std::size_t>(step)];
            least = std::min(least, processor_ms() - start);
            cost.rays[static_cast<std::size_t>(step)] = scene.stats().details.rays_cast;
        }
        EXPECT_GT(scene.contacts().size(), 100u);
        cost.as_standard = scene.stats().details.pairs_as_standard;
    }
    return cost;
}

TEST(FirstStep, OfCertifiedIsNoCliff) {
    const char* most = std::getenv("RAYCONTACT_TRIANGLES");
    for (const std::uint32_t triangles : {1'000u, 10'000u, 100'000u, 400'000u, 1'000'000u, 2'000'000u}) {
        if (triangles > (most ? std::strtoul(most, nullptr, 10) : 100'000u)) break;
        const auto shape = Shape::make(scenes::scene_model("sphere", triangles).mesh);
        for (const double pace : {0.0, 0.001}) {
            const Cost certified = cost_of(shape, Method::certified, pace);
            const Cost standard = cost_of(shape, Method::standard, pace);
            std::printf("[ ratio    ] %u triangles, pace %g: %.2f in the first step, %.2f in the last\n", triangles,
                        pace, certified.ms[0] / standard.ms[0], certified.ms[steps - 1] / standard.ms[steps - 1]);
            for (std::size_t step = 0; step < steps; ++step) {
                EXPECT_EQ(standard.rays[step] > 0, step == 0 || pace > 0) << "where nothing moves nothing is cast";
                EXPECT_LE(certified.rays[step], standard.rays[step]) << triangles << " triangles, step " << step;
                if (times_are_tested()) {
                    EXPECT_LT(certified.ms[step], 3 * standard.ms[step]) << triangles << " triangles, step " << step;
                }
            }
            // Fine, moving and in contact all over: nothing is spared, and the pair is left to `standard`.
            EXPECT_EQ(certified.as_standard, triangles >= 100'000 && pace > 0 ? 2u : 0u) << triangles;
            EXPECT_EQ(standard.as_standard, 0u);
        }
    }
}

} // namespace
} // namespace raycontact
