// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/seeds.h>

#include <report/plot.h>
#include <scenes/avalanche.h>
#include <scenes/peers/clock.h>
#include <scenes/simulation.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace raycontact::bench {

namespace {

constexpr double avalanche_body = 1; // metres, see avalanche()

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

void sweep(const SeedOptions& options, const Progress& progress, std::vector<SeedRow>& rows) {
    for (std::uint32_t i = 0; i < options.count; ++i) {
        scenes::SceneOptions how;
        how.bodies = options.bodies;
        how.seed = options.first + i;
        how.settings.speculative = Speculative::off;
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

const char* setting_of(bool fixed) {
    return fixed ? "fixed" : "auto";
}

std::string name_of(const SeedRow& row) {
    return std::string(to_string(row.method)) + ", " + setting_of(row.fixed)
           + (row.method == Method::predictive && !row.cast_lost_walks ? ", lost walks given up" : "");
}

} // namespace

std::vector<SeedRow> sweep_seeds(const SeedOptions& options, const Progress& progress) {
    std::vector<SeedRow> rows;
    until_stopped([&] { sweep(options, progress, rows); });
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

std::string table(std::span<const SeedRow> rows) {
    std::string text =
        fmt::format("fixed: displacement threshold {:g} of the size, confidence {:g}; auto: as the library chooses\n",
                    fixed_displacement, fixed_confidence);
    text += fmt::format("  {:>6} {:<42}{:>9}{:>9}{:>9}{:>9}{:>14}{:>12}\n", "seed", "", "missed", "invented", "other",
                        "wrong", "of rays", "of contacts");
    for (const SeedRow& r : rows)
        text += fmt::format("  {:>6} {:<42}{:>9}{:>9}{:>9}{:>9}{:>14}{:>12}\n", r.seed, name_of(r), r.wrong.missed,
                            r.wrong.invented, r.wrong.other_triangle, r.wrong.total(), r.wrong.rays_compared,
                            r.wrong.contacts_compared);
    for (const Reduction& r : reductions(rows)) {
        if (r.of_seeds.empty()) continue;
        text += fmt::format("fewer wrong rays, 1 - predictive / iterative, {}, lost walks {}: median {:.3f}, {:.3f} to "
                            "{:.3f} over {} seeds\n",
                            setting_of(r.fixed), r.cast_lost_walks ? "cast" : "given up", r.median, r.least, r.most,
                            r.of_seeds.size());
    }
    return text;
}

Json json(const SeedRow& r) {
    Json row{{"seed", r.seed},
             {"method", to_string(r.method)},
             {"setting", setting_of(r.fixed)},
             {"cast_lost_walks", r.cast_lost_walks},
             {"steps", r.steps}};
    put_counts(row, r.sums, r.wrong);
    return row;
}

Json json(const Reduction& r) {
    return {{"setting", setting_of(r.fixed)},
            {"cast_lost_walks", r.cast_lost_walks},
            {"of_seeds", r.of_seeds},
            {"median", r.median},
            {"least", r.least},
            {"most", r.most}};
}

std::string chart(std::span<const SeedRow> rows) {
    std::vector<report::BarGroup> groups;
    for (const SeedRow& r : rows) {
        const std::string name = "seed " + std::to_string(r.seed);
        if (groups.empty() || groups.back().name != name) groups.push_back({name, {}});
        groups.back().bars.emplace_back(name_of(r), 1e4 * r.wrong.percent());
    }
    return report::bar_chart("Wrong rays over the avalanche", "a million rays, logarithmic; none: no bar", groups);
}

} // namespace raycontact::bench
