// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/rolling.h>

#include <bench/peers/encounter.h>
#include <scenes/models/trigonometry.h>

#include <algorithm>
#include <cmath>

namespace raycontact::bench {

namespace {

/// One of the two bodies, turned by so many radians.
Pose rolled(const Encounter& meeting, bool second, double distance, double turns) {
    const scenes::SineCosine half = scenes::sine_cosine(turns / 2);
    return meeting.pose(second, distance, half.sine, half.cosine);
}

/// The largest distance of each pair, within `width` of where it was, at which it has so many contacts.
void find_distances(Scene& scene, std::span<const Pair> pairs, const std::vector<Encounter>& rolls, double turns,
                    std::uint32_t contacts, double width, std::vector<double>& distances) {
    std::vector<double> near(distances), far(distances);
    for (double& d : near) d = std::fmax(0, d - width);
    for (double& d : far) d += width;
    std::vector<std::uint32_t> counts;
    for (int halving = 0; halving < 14; ++halving) {
        for (std::size_t i = 0; i < rolls.size(); ++i) distances[i] = (near[i] + far[i]) / 2;
        place_encounters(scene, rolls.size(),
                         [&](std::size_t i, bool second) { return rolled(rolls[i], second, distances[i], turns); });
        counts.assign(rolls.size(), 0);
        for (const Contact& contact : scene.find_contacts(pairs)) ++counts[contact.body_a.slot / 2];
        for (std::size_t i = 0; i < rolls.size(); ++i) (counts[i] >= contacts ? near : far)[i] = distances[i];
    }
    distances = near;
}

void roll(Work& work, const std::vector<Encounter>& rolls, double turns, const RollingOptions& options) {
    const auto scene = make_scene(work, one_thread(Method::standard));
    const std::vector<Pair> pairs = encounter_pairs(rolls.size());
    const double radius = work.shapes[0]->radius();
    std::vector<double> distances(rolls.size(), radius);
    find_distances(*scene, pairs, rolls, 0, options.contacts, radius, distances);
    work.steps.clear();
    for (std::uint32_t k = 0; k < options.steps; ++k) {
        // A body that turns a little moves its surface no more than that; the bumps of the surface are the rest.
        if (k > 0 && turns > 0)
            find_distances(*scene, pairs, rolls, k * turns, options.contacts, 0.02 + 7 * turns * radius, distances);
        WorkStep& step = work.steps.emplace_back();
        for (std::size_t i = 0; i < rolls.size(); ++i) {
            step.poses.push_back(rolled(rolls[i], false, distances[i], k * turns));
            step.poses.push_back(rolled(rolls[i], true, distances[i], k * turns));
        }
        step.pairs = pairs;
    }
}

} // namespace

Work rolling_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                   const RollingOptions& options) {
    Work work = encounter_work(std::move(name), shape, std::move(source), options.pairs);
    const std::vector<Encounter> rolls = encounters(options.pairs);
    // A quarter of a turn moves a surface about one size; then as it came out.
    double turns = options.displacement / 8;
    roll(work, rolls, turns, options);
    if (turns > 0 && options.steps > 1) {
        for (int correction = 0; correction < 2; ++correction) {
            turns *= options.displacement / std::fmax(pace(work).median, 1e-12);
            roll(work, rolls, turns, options);
        }
    }
    return work;
}

} // namespace raycontact::bench
