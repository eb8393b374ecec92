// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/growth.h>

#include <bench/peers/work.h>
#include <scenes/avalanche.h>
#include <scenes/models/model.h>

#include <algorithm>

namespace raycontact::bench {

namespace {

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

GrowthRow of_bodies(std::uint32_t bodies, const GrowthOptions& options) {
    scenes::AvalancheOptions how;
    how.bodies = bodies;
    how.settings.threads = options.threads;
    scenes::Avalanche scene(how);
    for (std::uint32_t k = 0; k < options.steps; ++k) scene.step();
    GrowthRow row;
    row.part = "bodies";
    row.size = bodies;
    row.steps = std::max(options.steps / 5, 1u);
    std::vector<double> pairs, rays, contacts, narrow, each;
    const auto& rows = scene.log().rows;
    for (auto step = rows.end() - row.steps; step != rows.end(); ++step) {
        pairs.push_back(static_cast<double>(step->pairs));
        rays.push_back(static_cast<double>(step->rays));
        contacts.push_back(static_cast<double>(step->contacts));
        narrow.push_back(step->narrow_ms);
        each.push_back(1000 * step->narrow_ms / static_cast<double>(std::max<std::uint64_t>(step->pairs, 1)));
    }
    row.pairs = median(pairs);
    row.rays = median(rays);
    row.contacts = median(contacts);
    row.narrow_ms = median(narrow);
    row.us_per_pair = median(each);
    return row;
}

/// Always the procedural sphere, which every count can have: the same surface, sampled more and more finely.
GrowthRow of_triangles(std::uint32_t triangles, const GrowthOptions& options) {
    const scenes::Model model = scenes::scene_model("sphere", triangles);
    ApproachOptions approach;
    approach.pairs = options.pairs;
    approach.steps = 40;
    const Work work = approaching_pairs("triangles", Shape::make(model.mesh), model.source, approach);
    Settings settings;
    settings.threads = options.threads;
    Scene scene(settings);
    for (const std::uint32_t shape : work.body_shape) scene.add(work.shapes[shape]);
    GrowthRow row;
    row.part = "triangles";
    row.size = triangles;
    row.steps = static_cast<std::uint32_t>(work.steps.size());
    std::vector<std::vector<double>> times(work.steps.size()); // of each step, over the runs
    for (int run = 0; run < 5; ++run) {
        for (std::size_t k = 0; k < work.steps.size(); ++k) {
            const WorkStep& step = work.steps[k];
            for (BodyId body = 0; body < step.poses.size(); ++body) scene.set_pose(body, step.poses[body]);
            scene.step(step.pairs);
            times[k].push_back(scene.stats().narrow_ms);
            if (run > 0) continue;
            row.pairs += static_cast<double>(step.pairs.size()) / row.steps;
            row.rays += static_cast<double>(scene.stats().rays) / row.steps;
            row.contacts += static_cast<double>(scene.stats().contacts) / row.steps;
        }
    }
    // The same work each time: what exceeds the least is other programs'.
    for (const std::vector<double>& of_step : times)
        row.narrow_ms += *std::min_element(of_step.begin(), of_step.end()) / row.steps;
    row.us_per_pair = 1000 * row.narrow_ms / std::max(row.pairs, 1e-9);
    return row;
}

} // namespace

std::vector<GrowthRow> growth(const GrowthOptions& options, const std::function<void(const std::string&)>& progress) {
    std::vector<GrowthRow> rows;
    for (std::uint32_t triangles : {100u, 316u, 1'000u, 3'160u, 10'000u, 31'600u, 100'000u}) {
        if (triangles > options.triangles) break;
        progress("meshes of " + std::to_string(triangles) + " triangles");
        rows.push_back(of_triangles(triangles, options));
    }
    for (std::uint64_t bodies = 64; bodies <= options.bodies; bodies *= 2) {
        progress("avalanche of " + std::to_string(bodies) + " bodies");
        rows.push_back(of_bodies(static_cast<std::uint32_t>(bodies), options));
    }
    return rows;
}

} // namespace raycontact::bench
