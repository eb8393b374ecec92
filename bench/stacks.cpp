// SPDX-License-Identifier: Apache-2.0
// Stacks of coarse meshes in a Bullet world that differs by one line: RayContact with edges and with vertices alone,
// GImpact, and btBoxShape (btConvexHullShape for wedges) where all bodies are convex. Prints how far each has come from
// where it was put.
#include "bench/commands.h"
#include "bench/options.h"

#include <scenes/stacks/stack_world.h>
#include <scenes/stacks/verdict.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

namespace rc = raycontact;
using namespace rc::scenes;

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
    Verdict verdict;
    double ms = 0; ///< of a step
    bool ran = false, fell = false;
};

Row run(const Stack& stack, Ground ground, Finder finder, const Options& options, double allowed) {
    StackWorld world(stack, ground, finder, options.solver);
    Row row;
    row.ran = true;
    const int steps = static_cast<int>(std::lround(options.seconds * 60));
    const auto begin = std::chrono::steady_clock::now();
    bool down = false;
    for (int i = 0; i < steps; ++i) {
        world.step();
        if (!options.watch || down) continue;
        const Verdict now = judge(stack, world.poses());
        down = now.fell(stack, allowed);
        if (i < 3 || i % 30 == 0 || down) {
            std::printf("step %d: drift %.5f turn %.3f sunk %.5f overlap %.5f\n", i, now.drift, now.turn, now.sunk,
                        now.overlap);
            if (i < 3 || down) world.print_points(stdout);
        }
    }
    row.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count() / steps;
    row.verdict = judge(stack, world.poses());
    for (std::size_t i = 0; options.watch && i < stack.bodies.size(); ++i) {
        const rc::Vec3 a = stack.bodies[i].pose.translation, b = world.pose(i).translation;
        std::printf("body %zu has moved by %.4f %.4f %.4f m\n", i, b.x - a.x, b.y - a.y, b.z - a.z);
    }
    row.fell = row.verdict.fell(stack, allowed);
    return row;
}

std::string cell(const Stack& stack, const Row& row) {
    if (!row.ran) return "-";
    char text[64];
    const Verdict& v = row.verdict;
    if (stack.stands)
        std::snprintf(text, sizeof text, "%.2f%% %.2f %s", 100 * v.drift, v.turn, row.fell ? "FELL" : "ok");
    else
        std::snprintf(text, sizeof text, "s%.2f%% o%.2f%% %s", 100 * v.sunk, 100 * v.overlap, row.fell ? "FELL" : "ok");
    return text;
}

void run_all(const Options& options) {
    rc::report::Machine machine = rc::report::this_machine();
    rc::bench::BenchFiles files(options.out, machine, {"stacks"}, {".csv"});
    std::printf("%s\n%g s; drift in parts of a body's size, turn in degrees; of plates: sunk, overlap\n",
                heading(machine).c_str(), options.seconds);
    std::printf("%-14s %-6s", "stack", "ground");
    for (const Finder finder : finders) std::printf(" %-24s", std::string(to_string(finder)).c_str());
    std::printf("\n");
    std::string csv = std::string(rc::bench::machine_columns)
                      + ",stack,ground,finder,seconds,drift,turn_degrees,sunk,overlap,fell,step_ms\n";
    rc::bench::until_stopped([&] {
        for (const Stack& stack : all_stacks()) {
            if (stack.name.find(options.only) == std::string::npos) continue;
            for (const Ground ground : grounds) {
                if (!options.ground.empty() && to_string(ground) != options.ground) continue;
                std::printf("%-14s %-6s", stack.name.c_str(), std::string(to_string(ground)).c_str());
                double allowed = drift_limit;
                for (const Finder finder : finders) {
                    rc::bench::end_if_stopped();
                    Row row;
                    if ((options.finder.empty() || to_string(finder) == options.finder)
                        && (finder != Finder::convex || stack.convex())) {
                        row = run(stack, ground, finder, options, allowed);
                        if (finder == Finder::convex) allowed = std::max(allowed, 2 * row.verdict.drift);
                        char line[256];
                        std::snprintf(line, sizeof line, ",%s,%s,%s,%g,%.6f,%.4f,%.6f,%.6f,%d,%.4f\n",
                                      stack.name.c_str(), std::string(to_string(ground)).c_str(),
                                      std::string(to_string(finder)).c_str(), options.seconds, row.verdict.drift,
                                      row.verdict.turn, row.verdict.sunk, row.verdict.overlap, row.fell ? 1 : 0,
                                      row.ms);
                        csv += rc::bench::machine_fields(machine) + line;
                    }
                    std::printf(" %-24s", cell(stack, row).c_str());
                    std::fflush(stdout);
                }
                std::printf("\n");
            }
        }
    });
    rc::bench::finish(machine);
    if (files) {
        files.folder().write(rc::bench::result_name(machine, "stacks", ".csv"), csv);
        files.keep(machine);
    }
}

} // namespace

namespace raycontact::bench {

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
