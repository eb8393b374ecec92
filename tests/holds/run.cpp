// SPDX-License-Identifier: Apache-2.0
#include <tests/holds/run.h>

#include <scenes/quantile.h>
#include <tests/holds/depth.h>
#include <tests/stacks/verdict.h>

#include "mesh/vector.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace raycontact::scenes {

namespace {

/// Metres between two poses of a body; its turn counts with half its size.
double way(const Pose& from, const Pose& to, double size) {
    const Pose moved = relative_pose(from, to);
    return length(moved.translation) + angle_of(moved) * size / 2;
}

StackSolver solver_of(const Hold& hold, Finder finder, const HoldOptions& options) {
    StackSolver solver;
    solver.recommended = finder == Finder::edges || finder == Finder::vertices || options.recommended_for_all;
    if (solver.recommended) {
        solver.slop = options.slop ? options.slop : hold.slop;
        solver.iterations = options.iterations > 0 ? options.iterations : 20;
    }
    solver.speculative = options.speculative;
    return solver;
}

std::string words(const char* what, double value, double most, const char* unit) {
    char text[160];
    std::snprintf(text, sizeof text, "%s %.3g of %.3g %s", what, value, most, unit);
    return text;
}

/// Seconds until all sleep; -1 if they do not.
double fall_asleep(StackWorld& world, const Hold& hold) {
    const auto& bodies = hold.stack.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (!bodies[i].fixed) {
            world.body(i).forceActivationState(ACTIVE_TAG);
            world.body(i).setDeactivationTime(0);
        }
    for (int step = 1; step <= std::lround(5 * hold.hertz); ++step) {
        world.step(1 / hold.hertz);
        bool all = true;
        for (std::size_t i = 0; all && i < bodies.size(); ++i) all = bodies[i].fixed || !world.body(i).isActive();
        if (all) return step / hold.hertz;
    }
    return -1;
}

void judge_hold(const Hold& hold, HoldResult& result) {
    const auto fail = [&](const std::string& why) { result.failures.push_back(why); };
    if (result.passed > 0) fail(std::to_string(result.passed) + " passed through");
    // Negated, so that what is not a number does not hold.
    if (hold.deepest && !(result.deepest <= *hold.deepest * hold.size))
        fail(words("deepest", 1000 * result.deepest, 1000 * *hold.deepest * hold.size, "mm"));
    if (hold.rest && !(result.speed_max <= *hold.rest * hold.size))
        fail(words("speed", 1000 * result.speed_max, 1000 * *hold.rest * hold.size, "mm/s"));
    if (hold.rest && result.asleep < 0) fail("not asleep");
    if (hold.drift && !(result.drift <= *hold.drift * hold.size))
        fail(words("moved by", 1000 * result.drift, 1000 * *hold.drift * hold.size, "mm"));
    for (const Figure& figure : result.figures)
        if (!figure.holds()) {
            char text[160];
            std::snprintf(text, sizeof text, "%s %.3g %s", figure.name.c_str(), figure.value, figure.unit.c_str());
            fail(text);
        }
}

} // namespace

HoldResult run_hold(const Hold& scene, Finder finder, const HoldOptions& options) {
    using Clock = std::chrono::steady_clock;
    Hold hold = scene;
    if (options.hertz > 0) hold.hertz = options.hertz;
    StackWorld world(hold.stack, hold.ground == Ground::slab && finder == Finder::convex ? Ground::box : hold.ground,
                     finder, solver_of(hold, finder, options));
    std::optional<DepthProbe> probe;
    if (hold.deepest) probe.emplace(hold.stack, hold.ground);
    const auto course = hold.course();
    course->begin(world);
    const auto& bodies = hold.stack.bodies;
    const double dt = 1 / hold.hertz;
    const int steps = static_cast<int>(std::lround(std::min(options.seconds, hold.seconds) * hold.hertz));
    const int second = static_cast<int>(std::lround(hold.hertz)), curve = std::max(1, second / 10);
    HoldResult result;
    std::vector<Pose> poses = world.poses();
    std::vector<std::vector<double>> last_second; // of each step
    double spent = 0;
    int done = 0;
    while (done < steps) {
        course->before_step(world, dt);
        const auto begin = Clock::now();
        world.step(dt);
        spent += std::chrono::duration<double>(Clock::now() - begin).count();
        ++done;
        const std::vector<Pose> now = world.poses();
        std::vector<double> speeds;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            if (!bodies[i].fixed) speeds.push_back(way(poses[i], now[i], hold.stack.shapes[bodies[i].shape].size) / dt);
        poses = now;
        course->after_step(world, done * dt);
        if (done >= options.print_from && done <= options.print_to) {
            std::printf("step %d\n", done);
            for (std::size_t i = 0; i < bodies.size(); ++i)
                if (!bodies[i].fixed)
                    std::printf("  body %zu at %.5f %.5f %.5f\n", i, now[i].translation.x, now[i].translation.y,
                                now[i].translation.z);
            world.print_points(stdout);
        }
        if (done % curve == 0) result.speeds.emplace_back(done * dt, quantile(speeds, 0.5));
        last_second.push_back(std::move(speeds));
        if (last_second.size() > static_cast<std::size_t>(second)) last_second.erase(last_second.begin());
        result.ended_early = spent > options.patience;
        if (done % hold.sample == 0 || done == steps || result.ended_early) {
            const double deepest = probe ? probe->deepest(poses) : 0;
            result.deepest_end = deepest;
            if (deepest > result.deepest) {
                result.deepest = deepest;
                result.deepest_time = done * dt;
            }
            result.passed = std::max(result.passed, course->passed(poses));
        }
        if (result.ended_early) break;
    }
    result.seconds = done * dt;
    result.step_ms = 1000 * spent / std::max(done, 1);
    std::vector<double> all;
    for (const auto& speeds : last_second) all.insert(all.end(), speeds.begin(), speeds.end());
    for (const double speed : all) result.speed_max = std::max(result.speed_max, speed);
    result.speed_median = quantile(all, 0.5);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        result.drift = std::max(result.drift, length(poses[i].translation - bodies[i].pose.translation));
    }
    result.figures = course->figures();
    if (hold.rest && !result.ended_early) result.asleep = fall_asleep(world, hold);
    judge_hold(hold, result);
    return result;
}

} // namespace raycontact::scenes
