// SPDX-License-Identifier: Apache-2.0
// What a step of many bodies takes with our own broad phase: all in their places, a hundredth of them moving, all
// moving. On a grid with room between them, so that no pair is found, and close enough that neighbours touch. Medians
// of milliseconds; and what a query of the scene takes.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/scene.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>
#include <scenes/random.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::bench {

namespace {

struct Size {
    std::uint32_t bodies = 100'000, steps = 21, threads = 0;
    std::string devices = "cpu";
};

class Grid {
public:
    Grid(const Size& size, const std::shared_ptr<const Shape>& shape, double spacing) : scene_(settings(size)) {
        const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(double(size.bodies))));
        for (std::uint32_t i = 0; i < size.bodies; ++i) {
            const std::uint32_t x = i % side, y = i / side % side, z = i / side / side;
            Pose pose;
            pose.translation = {spacing * x, spacing * y, spacing * z};
            bodies_.push_back(scene_.add(shape, pose));
            poses_.push_back(pose);
        }
        for (int i = 0; i < 3; ++i) scene_.find_contacts(); // lists are made, and what the bodies came by is over
    }

    /// Every stride-th body moves on by `far`; 0: none.
    void measure(const char* name, std::size_t stride, double far, std::uint32_t steps) {
        std::vector<double> all, broad;
        for (std::uint32_t step = 0; step < steps; ++step) {
            const double begin = peers::now().wall;
            for (std::size_t i = 0; stride > 0 && i < bodies_.size(); i += stride) {
                poses_[i].translation.z += step % 2 == 0 ? far : -far;
                scene_.set_pose(bodies_[i], poses_[i]);
            }
            scene_.find_contacts();
            all.push_back(1e-3 * (peers::now().wall - begin));
            broad.push_back(scene_.stats().broad_ms);
        }
        std::printf("%-12s %8zu bodies %9llu pairs %10llu contacts %9.3f ms a step, broad phase %8.3f\n", name,
                    bodies_.size(), static_cast<unsigned long long>(scene_.stats().pairs),
                    static_cast<unsigned long long>(scene_.stats().contacts), median(all), median(broad));
        std::fflush(stdout);
    }

    /// After a hundredth of the bodies has moved, which the first ray learns.
    void measure_queries(double side) {
        for (std::size_t i = 0; i < bodies_.size(); i += 100) {
            poses_[i].translation.z += 0.001;
            scene_.set_pose(bodies_[i], poses_[i]);
        }
        constexpr std::size_t count = 2000;
        scenes::Random random(3);
        const auto place = [&] {
            const auto one = [&] { return side * 0.5 * (random.symmetric() + 1); };
            return Vec3{one(), one(), one()};
        };
        std::size_t hits = 0;
        const double begin = peers::now().cpu;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 direction{random.symmetric(), random.symmetric(), random.symmetric()};
            hits += scene_.raycast(place(), direction).has_value();
        }
        const double middle = peers::now().cpu;
        for (std::size_t i = 0; i < count; ++i) hits += scene_.closest_point(place()).has_value();
        const double last = peers::now().cpu;
        const Shape& swept = scene_.shape(bodies_[0]);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 from = place(), way{random.symmetric(), random.symmetric(), random.symmetric()};
            const double far = 10 * swept.radius();
            const Vec3 to{from.x + far * way.x, from.y + far * way.y, from.z + far * way.z};
            hits += scene_.sweep(swept, screw_motion({.translation = from}, {.translation = to})).has_value();
        }
        const double end = peers::now().cpu;
        std::printf("queries      %8zu bodies, one thread: a ray %.2f us, a closest point %.2f us, a sweep %.2f us "
                    "(%zu answers)\n",
                    bodies_.size(), (middle - begin) / count, (last - middle) / count, (end - last) / count, hits);
    }

private:
    static Settings settings(const Size& size) {
        Settings made;
        made.execution.threads = size.threads;
        made.execution.devices = size.devices;
        return made;
    }

    Scene scene_;
    std::vector<BodyId> bodies_;
    std::vector<Pose> poses_;
};

void measure(const Size& size) {
    const auto shape = Shape::make(scenes::scene_model("knot", 900).mesh);
    shape->prepare();
    const Vec3 low = shape->box_min(), high = shape->box_max();
    const double widest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    for (const auto& [name, spacing] : {std::pair("apart", 1.05 * widest), std::pair("touching", 0.9 * widest)}) {
        std::printf("%s\n", name);
        Grid grid(size, shape, spacing);
        grid.measure("at rest", 0, 0, size.steps);
        grid.measure("1 % moving", 100, 0.001 * widest, size.steps);
        grid.measure("all moving", 1, 0.001 * widest, size.steps);
        grid.measure_queries(spacing * std::cbrt(double(size.bodies)));
    }
}

} // namespace

void add_scale(CLI::App& app) {
    CLI::App* command = app.add_subcommand("scale", "What a step of many bodies takes, at rest and moving");
    auto size = std::make_shared<Size>();
    add_number(*command, "--bodies", size->bodies, "on a grid", 1u, 10'000'000u);
    add_number(*command, "--steps", size->steps, "of each kind; figures are medians", 1u, 100'000u);
    add_number(*command, "--threads", size->threads, "0: one per core", 0u, 1024u);
    command->add_option("--devices", size->devices, "as a scene's; one that is no CPU finds the pairs, too")
        ->type_name("LIST");
    command->callback([size] { measure(*size); });
}

} // namespace raycontact::bench
