// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/growth.h>

#include <bench/peers/approaching.h>
#include <bench/peers/rolling.h>
#include <bench/peers/stopped.h>
#include <bench/peers/work.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace raycontact::bench {

namespace {

constexpr Method methods[] = {Method::standard, Method::predictive, Method::certified};
constexpr std::uint32_t sizes[] = {100, 316, 1'000, 3'160, 10'000, 31'600, 100'000};
constexpr std::uint32_t least_of_slopes = 1'000;     // triangles; below, what a pair costs anyhow hides the rest
constexpr double creep = 0.0002;                     // of the size a step: a centimetre a second, of bodies of 1 m
constexpr std::pair<const char*, double> paces[] = { // of rolling pairs, by part
    {"contacts", RollingOptions().displacement},
    {"creeping", creep},
    {"still", 0}};
constexpr double displacements[] = {0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1};
constexpr std::uint32_t displaced_triangles = 10'000;

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// What one method did in each step of a work, the first left out.
struct Trial {
    Method method;
    std::unique_ptr<Scene> scene;
    std::vector<double> pairs, rays, contacts, rays_cast, walks, narrow_ms;

    void run(const Work& work, bool first) {
        rest(*scene, work.steps.front());
        for (std::size_t k = 0; k < work.steps.size(); ++k) {
            place(*scene, work.steps[k]);
            scene->find_contacts(work.steps[k].pairs);
            if (k == 0) continue;
            const StepStats& stats = scene->stats();
            // The same work each time: what exceeds the least is other programs'.
            if (!first) {
                narrow_ms[k - 1] = std::min(narrow_ms[k - 1], stats.narrow_ms);
                continue;
            }
            pairs.push_back(static_cast<double>(stats.pairs));
            rays.push_back(static_cast<double>(stats.details.rays));
            contacts.push_back(static_cast<double>(stats.contacts));
            rays_cast.push_back(static_cast<double>(stats.details.rays_cast));
            walks.push_back(static_cast<double>(stats.details.walks));
            narrow_ms.push_back(stats.narrow_ms);
        }
    }
};

void measure(const Work& work, const std::string& part, double size, int runs, const GrowthOptions& options,
             std::vector<GrowthRow>& rows) {
    std::vector<Trial> trials;
    for (const Method method : methods) {
        Settings settings;
        settings.features = Features::vertices;
        settings.method = method;
        settings.execution.threads = options.threads;
        trials.push_back({method, make_scene(work, settings), {}, {}, {}, {}, {}, {}});
    }
    for (int run = 0; run < runs; ++run)
        for (Trial& trial : trials) trial.run(work, run == 0);
    const double moved = pace(work).median;
    for (const Trial& trial : trials) {
        const auto middle = [&](const std::vector<double>& values) {
            return part == "bodies" ? median(values) : mean(values);
        };
        GrowthRow& row = rows.emplace_back();
        row.part = part;
        row.size = size;
        row.method = trial.method;
        row.steps = static_cast<std::uint32_t>(trial.pairs.size());
        row.pairs = middle(trial.pairs);
        row.rays = middle(trial.rays);
        row.contacts = middle(trial.contacts);
        row.rays_cast = middle(trial.rays_cast);
        row.walks = middle(trial.walks);
        row.narrow_ms = middle(trial.narrow_ms);
        row.us_per_pair = 1000 * row.narrow_ms / std::max(row.pairs, 1e-9);
        row.pace = moved;
    }
}

/// The last fifth of an avalanche, and the step before it, in which every pair is new.
Work end_of_avalanche(std::uint32_t bodies, const GrowthOptions& options) {
    AvalancheWorkOptions how;
    how.bodies = bodies;
    how.steps = std::min(std::max(options.steps / 5, 1u) + 1, options.steps);
    how.first = options.steps - how.steps;
    how.stride = 1;
    return avalanche_work(how);
}

/// Always the procedural sphere, which every count can have: the same surface, sampled more and more finely.
std::shared_ptr<const Shape> sphere(std::uint32_t triangles) {
    return Shape::make(scenes::scene_model("sphere", triangles).mesh);
}

Work rolling(std::uint32_t triangles, double displacement, const GrowthOptions& options) {
    RollingOptions roll;
    roll.pairs = options.pairs;
    roll.contacts = options.contacts;
    roll.displacement = displacement;
    return rolling_pairs("rolling", sphere(triangles), "a bumpy sphere", roll);
}

void grow(const GrowthOptions& options, const std::function<void(const std::string&)>& progress,
          std::vector<GrowthRow>& rows) {
    const auto wanted = [&](const char* part) {
        return options.parts.empty()
               || std::find(options.parts.begin(), options.parts.end(), part) != options.parts.end();
    };
    for (const std::uint32_t triangles : sizes) {
        if (triangles > options.triangles || !wanted("triangles")) break;
        progress("approaching meshes of " + std::to_string(triangles) + " triangles");
        ApproachOptions approach;
        approach.pairs = options.pairs;
        approach.steps = 40;
        measure(approaching_pairs("triangles", sphere(triangles), "a bumpy sphere", approach), "triangles", triangles,
                5, options, rows);
    }
    for (const auto& [part, displacement] : paces) {
        for (const std::uint32_t triangles : sizes) {
            if (triangles > options.triangles || !wanted(part)) break;
            if (triangles < least_of_slopes) continue;
            progress(std::string(part) + ": meshes of " + std::to_string(triangles) + " triangles");
            measure(rolling(triangles, displacement, options), part, triangles, 5, options, rows);
        }
    }
    for (const double displacement : displacements) {
        if (options.triangles == 0 || !wanted("displacement")) break;
        progress("rolling meshes, " + std::to_string(100 * displacement) + " % a step");
        measure(rolling(std::min(displaced_triangles, options.triangles), displacement, options), "displacement",
                displacement, 5, options, rows);
    }
    for (std::uint64_t bodies = 64; bodies <= options.bodies && wanted("bodies"); bodies *= 2) {
        progress("avalanche of " + std::to_string(bodies) + " bodies");
        measure(end_of_avalanche(static_cast<std::uint32_t>(bodies), options), "bodies", static_cast<double>(bodies), 3,
                options, rows);
    }
}

} // namespace

std::vector<GrowthRow> growth(const GrowthOptions& options, const std::function<void(const std::string&)>& progress) {
    std::vector<GrowthRow> rows;
    try {
        grow(options, progress, rows);
    } catch (const Stopped&) {
        // The sizes before count.
    }
    return rows;
}

bool only_mesh_grows(const std::string& part) {
    return std::any_of(std::begin(paces), std::end(paces), [&](const auto& pace) { return part == pace.first; });
}

std::vector<Slope> slopes(std::span<const GrowthRow> rows) {
    std::vector<Slope> all;
    for (const char* part : growth_parts) {
        const bool of_meshes = std::string(part) == "triangles" || only_mesh_grows(part);
        for (const Method method : methods) {
            double n = 0, x = 0, y = 0, xx = 0, xy = 0;
            Slope slope{part, method, 0, 0, 0};
            for (const GrowthRow& row : rows) {
                if (row.part != part || row.method != method || !(row.size > 0) || !(row.us_per_pair > 0)) continue;
                if (of_meshes && row.size < least_of_slopes) continue;
                const double a = std::log(row.size), b = std::log(row.us_per_pair);
                n += 1;
                x += a;
                y += b;
                xx += a * a;
                xy += a * b;
                if (slope.from == 0) slope.from = row.size;
                slope.to = row.size;
            }
            if (n < 2 || !(slope.to > slope.from)) continue;
            slope.power = (n * xy - x * y) / (n * xx - x * x);
            all.push_back(slope);
        }
    }
    return all;
}

} // namespace raycontact::bench
