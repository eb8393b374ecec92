// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/seeds.h>

#include <bench/peers/stopped.h>
#include <bench/peers/sums.h>
#include <scenes/avalanche.h>
#include <scenes/peers/clock.h>
#include <scenes/simulation.h>

#include <algorithm>
#include <memory>

namespace raycontact::bench {

using peers::median;

namespace {

constexpr double avalanche_body = 1; // metres, see AvalancheOptions

struct Watcher {
    SeedRow row;
    std::unique_ptr<Scene> scene;
};

std::vector<Watcher> watchers(std::uint64_t seed) {
    std::vector<Watcher> all;
    const auto add_one = [&](Method method, bool fixed, bool cast_lost_walks) {
        Watcher& one = all.emplace_back();
        one.row.seed = seed;
        one.row.method = method;
        one.row.fixed = fixed;
        one.row.cast_lost_walks = cast_lost_walks;
        Settings settings;
        settings.features = Features::vertices;
        settings.method = method;
        settings.paper.cast_lost_walks = cast_lost_walks;
        if (fixed) {
            settings.paper.displacement_threshold = fixed_displacement * avalanche_body;
            settings.paper.confidence = fixed_confidence;
        }
        one.scene = std::make_unique<Scene>(settings);
    };
    for (const bool fixed : {true, false}) {
        add_one(Method::iterative, fixed, true);
        add_one(Method::predictive, fixed, true);
        add_one(Method::predictive, fixed, false);
    }
    add_one(Method::certified, false, true);
    return all;
}

void sweep(const SeedOptions& options, const std::function<void(const std::string&)>& progress,
           std::vector<SeedRow>& rows) {
    for (std::uint32_t i = 0; i < options.count; ++i) {
        scenes::AvalancheOptions how;
        how.bodies = options.bodies;
        how.seed = options.first + i;
        how.settings.speculative = false;
        scenes::Simulation simulation(scenes::avalanche(how));
        const scenes::RunLog& log = simulation.log();
        Settings standard;
        standard.features = Features::vertices;
        standard.method = Method::standard;
        standard.paper.skip_outside = false;
        Scene reference(standard);
        std::vector<Watcher> all = watchers(how.seed);
        for (const std::uint32_t shape : log.body_shape) {
            reference.add(log.shapes[shape]);
            for (Watcher& one : all) one.scene->add(log.shapes[shape]);
        }
        for (std::uint32_t k = 0; k < options.steps; ++k) {
            if (k % 20 == 0)
                progress("seed " + std::to_string(how.seed) + ": step " + std::to_string(k) + " of "
                         + std::to_string(options.steps));
            simulation.step();
            const Scene& watched = simulation.scene();
            const auto follow = [&](Scene& scene) {
                for (const BodyId body : watched.bodies()) scene.set_pose(body, watched.pose(body));
                return scene.find_contacts(watched.pairs());
            };
            const std::span<const Contact> right = follow(reference);
            for (Watcher& one : all) {
                one.row.wrong.add(follow(*one.scene), right);
                one.row.wrong.rays_compared += reference.stats().details.rays;
                add(one.row.sums, one.scene->stats());
                ++one.row.steps;
            }
        }
        for (const Watcher& one : all) rows.push_back(one.row);
    }
}

} // namespace

std::vector<SeedRow> sweep_seeds(const SeedOptions& options, const std::function<void(const std::string&)>& progress) {
    std::vector<SeedRow> rows;
    try {
        sweep(options, progress, rows);
    } catch (const Stopped&) {
        // The seeds before count.
    }
    return rows;
}

std::vector<Reduction> reductions(std::span<const SeedRow> rows) {
    std::vector<Reduction> all;
    for (const bool fixed : {true, false}) {
        for (const bool cast_lost_walks : {true, false}) {
            Reduction& reduction = all.emplace_back();
            reduction.fixed = fixed;
            reduction.cast_lost_walks = cast_lost_walks;
            for (const SeedRow& one : rows) {
                if (one.method != Method::predictive || one.fixed != fixed || one.cast_lost_walks != cast_lost_walks)
                    continue;
                for (const SeedRow& other : rows)
                    if (other.method == Method::iterative && other.seed == one.seed && other.fixed == fixed
                        && other.wrong.total() > 0)
                        reduction.of_seeds.push_back(
                            1 - static_cast<double>(one.wrong.total()) / static_cast<double>(other.wrong.total()));
            }
            if (reduction.of_seeds.empty()) continue;
            reduction.median = median(reduction.of_seeds);
            reduction.least = *std::min_element(reduction.of_seeds.begin(), reduction.of_seeds.end());
            reduction.most = *std::max_element(reduction.of_seeds.begin(), reduction.of_seeds.end());
        }
    }
    return all;
}

} // namespace raycontact::bench
