// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/growth.h>

#include <bench/peers/motion.h>
#include <report/plot.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>

#include <fmt/format.h>

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
    std::vector<GrowthRow> steps;

    void run(const Work& work, bool first) {
        rest(*scene, work.steps.front());
        for (std::size_t k = 0; k < work.steps.size(); ++k) {
            place(*scene, work.steps[k]);
            scene->find_contacts(work.steps[k].pairs);
            if (k == 0) continue;
            const StepStats& stats = scene->stats();
            // The same work each time: what exceeds the least is other programs'.
            if (!first) {
                steps[k - 1].narrow_ms = std::min(steps[k - 1].narrow_ms, stats.narrow_ms);
                continue;
            }
            GrowthRow& step = steps.emplace_back();
            step.pairs = static_cast<double>(stats.pairs);
            step.rays = static_cast<double>(stats.details.rays);
            step.contacts = static_cast<double>(stats.contacts);
            step.rays_cast = static_cast<double>(stats.details.rays_cast);
            step.walks = static_cast<double>(stats.details.walks);
            step.narrow_ms = stats.narrow_ms;
        }
    }
};

void measure(const Work& work, const std::string& part, double size, int runs, const GrowthOptions& options,
             std::vector<GrowthRow>& rows) {
    std::vector<Trial> trials;
    for (const Method method : methods) {
        Settings settings = one_thread(method);
        settings.execution.threads = options.threads;
        trials.push_back({method, make_scene(work, settings), {}});
    }
    for (int run = 0; run < runs; ++run)
        for (Trial& trial : trials) trial.run(work, run == 0);
    const double moved = pace(work).median;
    for (const Trial& trial : trials) {
        GrowthRow& row = rows.emplace_back();
        row.part = part;
        row.size = size;
        row.method = trial.method;
        row.steps = static_cast<std::uint32_t>(trial.steps.size());
        for (const auto figure : {&GrowthRow::pairs, &GrowthRow::rays, &GrowthRow::contacts, &GrowthRow::rays_cast,
                                  &GrowthRow::walks, &GrowthRow::narrow_ms}) {
            std::vector<double> values;
            for (const GrowthRow& step : trial.steps) values.push_back(step.*figure);
            row.*figure = part == "bodies" ? median(values) : mean(values);
        }
        row.us_per_pair = 1000 * row.narrow_ms / std::max(row.pairs, 1e-9);
        row.pace = moved;
    }
}

/// The last fifth of an avalanche, and the step before it, in which every pair is new.
Work end_of_avalanche(std::uint32_t bodies, const GrowthOptions& options) {
    const std::uint32_t steps = std::min(std::max(options.steps / 5, 1u) + 1, options.steps);
    return avalanche_work({.bodies = bodies, .first = options.steps - steps, .steps = steps, .stride = 1});
}

/// Always the procedural sphere, which every count can have: the same surface, sampled more and more finely.
std::shared_ptr<const Shape> sphere(std::uint32_t triangles) {
    return Shape::make(scenes::scene_model("sphere", triangles).mesh);
}

Work rolling(std::uint32_t triangles, double displacement, const GrowthOptions& options) {
    return rolling_pairs("rolling", sphere(triangles), "a bumpy sphere",
                         {.pairs = options.pairs, .contacts = options.contacts, .displacement = displacement});
}

void grow(const GrowthOptions& options, const Progress& progress, std::vector<GrowthRow>& rows) {
    const auto wanted = [&](const char* part) {
        return options.parts.empty()
               || std::find(options.parts.begin(), options.parts.end(), part) != options.parts.end();
    };
    for (const std::uint32_t triangles : sizes) {
        if (triangles > options.triangles || !wanted("triangles")) break;
        progress("approaching meshes of " + std::to_string(triangles) + " triangles");
        const ApproachOptions approach{.pairs = options.pairs, .steps = 40};
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

/// Of the parts with contacts alike: what grows is the mesh alone.
bool only_mesh_grows(const std::string& part) {
    return std::any_of(std::begin(paces), std::end(paces), [&](const auto& pace) { return part == pace.first; });
}

std::string unit_of(const std::string& part) {
    if (only_mesh_grows(part)) return "triangles (" + part + ")";
    return part;
}

} // namespace

std::vector<GrowthRow> growth(const GrowthOptions& options, const Progress& progress) {
    std::vector<GrowthRow> rows;
    until_stopped([&] { grow(options, progress, rows); });
    return rows;
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

std::string table(std::span<const GrowthRow> rows) {
    std::string text = fmt::format("  {:<13}{:>9} {:<11}{:>10}{:>12}{:>11}{:>11}{:>9}{:>12}{:>10}{:>8}\n", "", "", "",
                                   "pairs", "rays", "cast", "contacts", "walks", "narrow ms", "us/pair", "pace %");
    for (const GrowthRow& r : rows)
        text +=
            fmt::format("  {:<13}{:>9g} {:<11}{:>10.1f}{:>12.1f}{:>11.1f}{:>11.1f}{:>9.1f}{:>12.4f}{:>10.3f}{:>8.2f}\n",
                        r.part, r.size, to_string(r.method), r.pairs, r.rays, r.rays_cast, r.contacts, r.walks,
                        r.narrow_ms, r.us_per_pair, 100 * r.pace);
    for (const Slope& s : slopes(rows))
        text += fmt::format("us a pair grows as {} to the power of {:.2f} with {} ({:g} to {:g})\n", unit_of(s.part),
                            s.power, to_string(s.method), s.from, s.to);
    return text;
}

Json json(const GrowthRow& r) {
    return {{"part", r.part},           {"size", r.size},           {"method", to_string(r.method)},
            {"steps", r.steps},         {"pairs", r.pairs},         {"rays", r.rays},
            {"contacts", r.contacts},   {"narrow_ms", r.narrow_ms}, {"us_per_pair", r.us_per_pair},
            {"rays_cast", r.rays_cast}, {"walks", r.walks},         {"pace_median", r.pace}};
}

Json json(const Slope& s) {
    return {{"part", s.part}, {"method", to_string(s.method)}, {"power", s.power}, {"from", s.from}, {"to", s.to}};
}

std::string chart(std::span<const GrowthRow> rows) {
    struct Part {
        const char *part, *title, *over;
    };
    std::vector<report::Plot> plots;
    for (const Part& part :
         {Part{"bodies", "Avalanche", "bodies"}, Part{"triangles", "Approaching pairs", "triangles a mesh"},
          Part{"contacts", "Rolling pairs, contacts alike", "triangles a mesh"},
          Part{"creeping", "Creeping pairs, contacts alike", "triangles a mesh"},
          Part{"still", "The same pairs, still", "triangles a mesh"},
          Part{"displacement", "Rolling pairs, contacts alike", "displacement a step, part of the size"}}) {
        report::Plot& plot = plots.emplace_back();
        plot.title = part.title;
        plot.unit = "us a pair and step";
        plot.over = part.over;
        plot.logarithmic = true;
        for (const Method method : methods) {
            report::Line& line = plot.lines.emplace_back();
            line.name = to_string(method);
            for (const GrowthRow& r : rows)
                if (r.part == part.part && r.method == method) line.points.emplace_back(r.size, r.us_per_pair);
        }
        report::Line& contacts = plot.lines.emplace_back();
        contacts.name = "contacts a pair";
        for (const GrowthRow& r : rows)
            if (r.part == part.part && r.method == Method::standard)
                contacts.points.emplace_back(r.size, r.contacts / std::max(r.pairs, 1e-9));
    }
    return report::plot_svg(plots);
}

} // namespace raycontact::bench
