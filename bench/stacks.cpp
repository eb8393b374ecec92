// SPDX-License-Identifier: Apache-2.0
// Stacks of coarse meshes in a Bullet world that differs by one line: RayContact with edges and with vertices alone,
// GImpact, and btBoxShape (btConvexHullShape for wedges) where all bodies are convex. Prints how far each has come from
// where it was put.
#include "bench/commands.h"
#include "bench/options.h"

#include <scenes/peers/clock.h>
#include <tests/stacks/stack_world.h>
#include <tests/stacks/verdict.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

namespace raycontact::bench {

using namespace scenes;

namespace {

constexpr Finder finders[] = {Finder::convex, Finder::edges, Finder::vertices, Finder::gimpact};
constexpr Ground grounds[] = {Ground::plane, Ground::slab, Ground::box, Ground::quad};

struct Options {
    double seconds = 5;
    std::string only, ground, finder, out;
    StackSolver solver;
    bool watch = false; ///< print the contacts before the first step after which the stack is down
};

struct Row {
    scenes::Verdict verdict;
    double ms = 0; ///< of a step
    bool fell = false;
};

Row run(const Stack& stack, Ground ground, Finder finder, const Options& options, double allowed) {
    StackWorld world(stack, ground, finder, options.solver);
    Row row;
    const int steps = static_cast<int>(std::lround(options.seconds * 60));
    const double begin = peers::now().wall;
    bool down = false;
    for (int i = 0; i < steps; ++i) {
        world.step();
        if (!options.watch || down) continue;
        const scenes::Verdict now = judge(stack, world.poses());
        down = now.fell(stack, allowed);
        if (i < 3 || i % 30 == 0 || down) {
            std::printf("step %d: drift %.5f turn %.3f sunk %.5f overlap %.5f\n", i, now.drift, now.turn, now.sunk,
                        now.overlap);
            if (i < 3 || down) world.print_points(stdout);
        }
    }
    row.ms = 1e-3 * (peers::now().wall - begin) / steps;
    row.verdict = judge(stack, world.poses());
    for (std::size_t i = 0; options.watch && i < stack.bodies.size(); ++i) {
        const Vec3 a = stack.bodies[i].pose.translation, b = world.pose(i).translation;
        std::printf("body %zu has moved by %.4f %.4f %.4f m\n", i, b.x - a.x, b.y - a.y, b.z - a.z);
    }
    row.fell = row.verdict.fell(stack, allowed);
    return row;
}

std::string cell(const Stack& stack, const Row& row) {
    const scenes::Verdict& v = row.verdict;
    return fmt::format("{} {}",
                       stack.stands ? fmt::format("{:.2f}% {:.2f}", 100 * v.drift, v.turn)
                                    : fmt::format("s{:.2f}% o{:.2f}%", 100 * v.sunk, 100 * v.overlap),
                       row.fell ? "FELL" : "ok");
}

void run_all(const Options& options) {
    Output out(options.out, {"stacks"}, {".csv"});
    fmt::print("{}\n{} s; drift in parts of a body's size, turn in degrees; of plates: sunk, overlap\n",
               heading(out.machine), options.seconds);
    fmt::print("{:<14} {:<6}", "stack", "ground");
    for (const Finder finder : finders) fmt::print(" {:<24}", to_string(finder));
    fmt::print("\n");
    Json rows = Json::array();
    until_stopped([&] {
        for (const Stack& stack : all_stacks()) {
            if (stack.name.find(options.only) == std::string::npos) continue;
            for (const Ground ground : grounds) {
                if (!options.ground.empty() && to_string(ground) != options.ground) continue;
                fmt::print("{:<14} {:<6}", stack.name, to_string(ground));
                double allowed = drift_limit;
                for (const Finder finder : finders) {
                    end_if_stopped();
                    std::string told = "-";
                    if ((options.finder.empty() || to_string(finder) == options.finder)
                        && (finder != Finder::convex || stack.convex())) {
                        const Row row = run(stack, ground, finder, options, allowed);
                        const scenes::Verdict& v = row.verdict;
                        if (finder == Finder::convex) allowed = std::max(allowed, 2 * v.drift);
                        rows.push_back(Json::array({stack.name, to_string(ground), to_string(finder), options.seconds,
                                                    v.drift, v.turn, v.sunk, v.overlap, row.fell, row.ms}));
                        told = cell(stack, row);
                    }
                    fmt::print(" {:<24}", told);
                    std::fflush(stdout);
                }
                fmt::print("\n");
            }
        }
    });
    out.finish();
    out.write("stacks", ".csv",
              csv(out.machine, "stack,ground,finder,seconds,drift,turn_degrees,sunk,overlap,fell,step_ms", rows));
    out.keep();
}

} // namespace

void add_stacks(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "stacks", "Which stacks of coarse meshes stand in Bullet: edges, vertices, GImpact, Bullet's own boxes");
    auto o = std::make_shared<Options>();
    add_world_options(*command, o->seconds, o->only, o->finder, "convex, edges, vertices or gimpact");
    command->add_option("--ground", o->ground, "this one alone: plane, slab, box or quad")->type_name("WORD");
    add_number(*command, "--iterations", o->solver.iterations, "of the solver", 1, 100'000);
    add_number(*command, "--slop", o->solver.slop, "that the solver leaves", 0.0, 1.0);
    command->add_flag("--two", o->solver.two_friction_directions, "two directions of friction");
    command->add_flag("--watch", o->watch, "print the contacts of the first steps, and of that in which a stack falls");
    add_out(*command, "--out", o->out, "write DIR/<machine>/stacks-<date>.csv")->type_name("DIR");
    command->callback([o] { run_all(*o); });
}

} // namespace raycontact::bench
