// SPDX-License-Identifier: Apache-2.0
#include "cli/gimpact_turns.h"

#include <report/svg.h>
#include <scenes/peers/clock.h>
#include <scenes/peers/peer.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace raycontact;
using namespace raycontact::peers;

constexpr double seconds_a_pass = 0.1; ///< of GImpact over a frame's pairs; meshes of a user's own can be large
constexpr std::size_t turns = 3;

Work work_of(const scenes::RunLog& log, const scenes::Frame& frame) {
    Work work;
    work.shapes = log.shapes;
    work.body_shape.assign(log.body_shape.begin(),
                           log.body_shape.begin() + static_cast<std::ptrdiff_t>(frame.poses.size()));
    work.steps.push_back({frame.poses, {}});
    find_pairs(work);
    return work;
}

double seconds(Peer& peer, const WorkStep& step, Found& found) {
    const double start = now().cpu;
    found = peer.detect(step);
    return 1e-6 * (now().cpu - start);
}

std::vector<Pair> evenly(const std::vector<Pair>& pairs, std::size_t count) {
    std::vector<Pair> some;
    for (std::size_t k = 0; k < count; ++k) some.push_back(pairs[k * pairs.size() / count]);
    return some;
}

/// So many of the pairs that a pass of the slower one stays short.
void leave_out(Peer& slow, WorkStep& step) {
    constexpr std::size_t first = 16;
    if (step.pairs.size() <= first) return;
    WorkStep trial{step.poses, evenly(step.pairs, first)};
    Found ignored;
    seconds(slow, trial, ignored);
    const double each = seconds(slow, trial, ignored) / first;
    const double most = each > 0 ? seconds_a_pass / each : double(step.pairs.size());
    if (most < double(step.pairs.size()))
        step.pairs = evenly(step.pairs, std::max(first, static_cast<std::size_t>(most)));
}

struct Sums {
    std::uint64_t pairs = 0;
    std::array<double, 2> seconds{};
    std::array<std::uint64_t, 2> contacts{};
};

void add_frame(const scenes::RunLog& log, const scenes::Frame& frame, Sums& sums) {
    Work work = work_of(log, frame);
    WorkStep& step = work.steps.front();
    if (step.pairs.empty()) return;
    const Entrant entrants[] = {ours("bvh", Method::standard, Caster::bvh), gimpact()};
    std::unique_ptr<Peer> peers[] = {entrants[0].make(work), entrants[1].make(work)};
    leave_out(*peers[1], step);
    std::array<std::vector<double>, 2> times;
    std::array<Found, 2> found;
    for (std::size_t turn = 0; turn <= turns; ++turn) // the first warms up
        for (std::size_t k = 0; k < 2; ++k) {
            const double took = seconds(*peers[k], step, found[k]);
            if (turn > 0) times[k].push_back(took);
        }
    sums.pairs += step.pairs.size();
    for (std::size_t k = 0; k < 2; ++k) {
        sums.seconds[k] += median(times[k]);
        sums.contacts[k] += found[k].contacts;
    }
}

} // namespace

report::Comparison compare_with_gimpact(const scenes::RunLog& log) {
    report::Comparison comparison;
    Sums sums;
    std::string steps;
    const std::size_t frames = log.frames.size();
    for (std::size_t third = 1; third <= 3; ++third) {
        if (frames * third / 3 == 0) continue;
        const scenes::Frame& frame = log.frames[frames * third / 3 - 1];
        const std::uint64_t before = sums.pairs;
        add_frame(log, frame, sums);
        if (sums.pairs > before) steps += (steps.empty() ? "" : ", ") + std::to_string(frame.step);
    }
    if (sums.pairs == 0 || !(sums.seconds[0] > 0)) return comparison;
    const auto each = [&](std::size_t k) { return 1e6 * sums.seconds[k] / double(sums.pairs); };
    comparison.title = "Beside Bullet's GImpact";
    comparison.rows = {
        {"RayContact, a pair", report::readable(each(0)), "\u00b5s",
         "method standard: nothing kept from an earlier step"},
        {"GImpact, a pair", report::readable(each(1)), "\u00b5s", gimpact().what},
        {"GImpact over RayContact", report::readable(each(1) / each(0)), "times", "processor time"},
        {"RayContact, contacts", report::readable(double(sums.contacts[0])), "", "vertices inside the other mesh"},
        {"GImpact, contacts", report::readable(double(sums.contacts[1])), "",
         "of triangles that cross, with Bullet's depths"}};
    comparison.note = fmt::format(
        "Both found the contacts of {} pairs at the poses of step {}, by turns on one thread of this machine: median "
        "of "
        "{} turns a step, poses set, contacts read. The two answer different questions, so their contacts cannot be "
        "compared one by one. `raycontact-bench peers` has more works and peers.",
        sums.pairs, steps, turns);
    return comparison;
}
