// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>
#include <reproduce/series.h>

#include <fmt/format.h>

#include <algorithm>

namespace raycontact::reproduce {

namespace {

SimulationOptions driven_by(const Workshop& shop, Method method, const std::string& scene, std::uint64_t seed) {
    return {scene, seed, shop.plan().size(scene), as_in_the_paper(method)};
}

/// The length of every ray that `standard` finds along the poses of that simulation, a number a step.
Json measure(const Workshop& shop, const SimulationOptions& options, double cost, const Tick& tick) {
    const auto file = shop.recording(options, tick);
    Json result{{"length", Json::array()}, {"contacts", Json::array()}};
    side_by_side({{file, by_default(Method::standard)}}, [&](std::uint32_t, std::span<Scene* const> scenes) {
        result["length"].push_back(scenes[0]->stats().ray_length);
        result["contacts"].push_back(scenes[0]->stats().contacts);
        tick(cost / options.size.steps);
    });
    if (options.seed > 1) shop.drop_recording(options); // that of seed 1 is followed for Figures 11 and 12, too
    return result;
}

Outcome show(const Workshop& shop, const std::vector<Json>& found) {
    Outcome out;
    std::size_t at = 0;
    for (const std::string& scene : scene_names()) {
        const double paper = scene == "rain" ? 56 : 45;
        report::Plot plot{"Section 5.2: length of the rays of standard, " + scene,
                          "m",
                          fmt::format("Seed 1. The paper: {:.0f} % shorter over the whole scene.", paper),
                          {line("driven by iterative", found[at]["length"].get<Series>()),
                           line("driven by predictive", found[at + 1]["length"].get<Series>())},
                          report::over_steps(1.0 / 60)};
        Table table{"Cumulative length, " + scene, {"seed", "iterative", "predictive", "shorter"}, {}};
        Series shorter;
        for (std::uint32_t seed = 1; seed <= shop.plan().seeds; ++seed, at += 2) {
            const double iterative = sum(found[at]["length"].get<Series>());
            const double predictive = sum(found[at + 1]["length"].get<Series>());
            shorter.push_back(iterative > 0 ? 100 * (1 - predictive / iterative) : 0);
            table.rows.push_back({std::to_string(seed), fmt::format("{:.1f} m", iterative),
                                  fmt::format("{:.1f} m", predictive), percent(shorter.back())});
        }
        const auto [least, most] = std::minmax_element(shorter.begin(), shorter.end());
        plot.note += " Here " + percent(median(shorter)) + " (median of the seeds).";
        out.numbers.push_back(compared(
            "lengths." + scene, paper, median(shorter), "% shorter", Better::higher,
            fmt::format(
                "median of {} seeds, range {} to {}; depends on the displacement threshold, which the paper does "
                "not state ({} m here), and on the response",
                shorter.size(), percent(*least), percent(*most), constants::displacement_threshold)));
        out.plots.push_back(plot);
        out.tables.push_back(table);
    }
    out.paragraphs = {
        "One simulation is driven by the contacts of iterative, one by those of predictive, with the same "
        "fixed constants. Both are recorded, and standard measures all rays along both recordings."};
    return out;
}

} // namespace

Experiment lengths(const Workshop& shop) {
    Experiment e;
    e.name = "lengths";
    e.title = "Section 5.2: interpenetration with and without prediction";
    for (const std::string& scene : scene_names())
        for (std::uint32_t seed = 1; seed <= shop.plan().seeds; ++seed)
            for (const Method method : {Method::iterative, Method::predictive}) {
                const SimulationOptions options = driven_by(shop, method, scene, seed);
                const double cost = Workshop::cost(options) / 2;
                e.parts.push_back({fmt::format("lengths-{}-{}-seed{}", scene, to_string(method), seed),
                                   shop.key("lengths", options), 3 * cost, [&shop, options, cost](const Tick& tick) {
                                       return measure(shop, options, cost, tick);
                                   }});
            }
    e.show = [&shop](const std::vector<Json>& found) { return show(shop, found); };
    return e;
}

} // namespace raycontact::reproduce
