// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>
#include <reproduce/phases.h>
#include <reproduce/series.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace raycontact::reproduce {

namespace {

constexpr Method both[] = {Method::iterative, Method::predictive};

/// Milliseconds of the contact finding in each step.
Json measure(const Workshop& shop, const std::string& scene, Caster caster, bool own, const Tick& tick) {
    std::vector<Follow> follow;
    for (const Method method : both) {
        Settings settings = as_in_the_paper(method, shop.plan().constants);
        settings.paper.caster = caster;
        const SimulationOptions options = own ? shop.driven_by(method, scene) : shop.base(scene);
        follow.push_back({shop.recording(options), settings});
    }
    Json result;
    side_by_side(follow, [&](std::uint32_t, std::span<Scene* const> scenes) {
        for (std::size_t k = 0; k < 2; ++k) {
            Json& of = result[std::string(to_string(both[k]))];
            const StepStats& stats = scenes[k]->stats();
            of["ms"].push_back(stats.narrow_ms);
            of["cast"].push_back(stats.details.rays_cast);
            of["full"].push_back(stats.details.pairs_full);
            of["ordered_pairs"].push_back(2 * stats.pairs);
        }
        tick(1.0 / shop.plan().size(scene).steps);
    });
    return result;
}

struct Measured {
    Caster caster;
    bool own;
};
constexpr Measured all_measured[] = {
    {Caster::basic, true}, {Caster::bvh, true}, {Caster::basic, false}, {Caster::bvh, false}};

Outcome show(const Constants& constants, const std::string& scene, const std::vector<Json>& found) {
    Outcome out;
    const bool rain = scene == "rain";
    Table table{
        "Speed-up by prediction, " + scene,
        {"caster", "poses", "phase B", "phase C", "whole scene", "rays cast, predictive over iterative, phase B"},
        {}};
    for (std::size_t k = 0; k < std::size(all_measured); ++k) {
        const auto [caster, own] = all_measured[k];
        const Json &iterative = found[k]["iterative"], &predictive = found[k]["predictive"];
        const auto a = iterative["ms"].get<Series>(), b = predictive["ms"].get<Series>();
        const std::vector<Phase> phase =
            phases(iterative["full"].get<Series>(), iterative["ordered_pairs"].get<Series>());
        const double rays =
            speed_up(predictive["cast"].get<Series>(), iterative["cast"].get<Series>(), phase, Phase::b);
        const double in_b = speed_up(a, b, phase, Phase::b), in_c = speed_up(a, b, phase, Phase::c);
        const std::string word(to_string(caster));
        table.rows.push_back({word, own ? "own simulations" : "one recording", fmt::format("{:.2f}", in_b),
                              fmt::format("{:.2f}", in_c), fmt::format("{:.2f}", sum(a) / std::max(sum(b), 1e-9)),
                              fmt::format("{:.2f}", rays)});
        if (!own) continue;
        const bool basic = caster == Caster::basic;
        report::Plot plot{fmt::format("{}: time, caster {}", rain ? "Figure 12" : "Figure 11", word),
                          "ms",
                          "Contact finding, each method along its own simulation. A bar below marks phase B. ",
                          {},
                          ""};
        plot.over = report::over_steps(1.0 / 60);
        if (!rain)
            plot.note += fmt::format("The paper, part B: {} times as fast with prediction; here {:.2f}.",
                                     basic ? "1.27" : "0.78", in_b);
        plot.lines = {line("iterative", a), line("predictive", b)};
        Series marks(phase.size());
        const double height = 0.02 * *std::max_element(a.begin(), a.end());
        for (std::size_t i = 0; i < phase.size(); ++i) marks[i] = phase[i] == Phase::b ? height : std::nan("");
        plot.lines.push_back(line("phase B", marks));
        out.plots.push_back(plot);
        if (!rain)
            out.numbers.push_back(compared(
                basic ? "speedup.basic" : "speedup.stackless", basic ? 1.27 : 0.78, in_b, "times as fast",
                Better::higher,
                fmt::format(
                    "time of iterative over that of predictive in phase B of the avalanche, caster {}, on this "
                    "machine; phase C {:.2f}. There predictive casts {:.1f} times as many rays: it looks at the "
                    "vertices of bounds that are {:.0f} cm wider on each side, and a body's size is 1 m. The paper "
                    "does not state by how much it widens them; it measured on a GTX 660, \"an average\"",
                    word, in_c, rays, 100 * constants.distance_extension)));
    }
    out.tables.push_back(table);
    out.paragraphs = {"The paper's text names two parts of Figure 11: B, in which most pairs are cast in full, and C, "
                      "in which most are updated. Here a second is of phase B if the share of ordered pairs that "
                      "iterative tests in full lies above the middle between the least and the largest share of the "
                      "run's seconds with pairs; all other seconds are of phase C. Constants fixed as in Figure 9."};
    return out;
}

} // namespace

Experiment times(const Workshop& shop, const std::string& scene) {
    Experiment e;
    const bool rain = scene == "rain";
    e.name = rain ? "fig12" : "fig11";
    e.title = fmt::format("{}: time with and without prediction, {}", rain ? "Figure 12" : "Figure 11", scene);
    for (const auto& [caster, own] : all_measured) {
        Json settings{{"scene", scene}, {"own", own}, {"caster", to_string(caster)}};
        for (const Method method : both)
            settings[std::string(to_string(method))] = to_json(as_in_the_paper(method, shop.plan().constants));
        const double cost = Workshop::cost(shop.base(scene)) * (caster == Caster::basic ? (rain ? 12 : 4) : 0.7);
        e.parts.push_back({fmt::format("times-{}-{}-{}", scene, to_string(caster), own ? "own" : "same"),
                           shop.key("times", settings), cost,
                           [&shop, scene, caster = caster, own = own](const Tick& tick) {
                               return measure(shop, scene, caster, own, tick);
                           }});
    }
    e.show = [&shop, scene](const std::vector<Json>& found) { return show(shop.plan().constants, scene, found); };
    return e;
}

} // namespace raycontact::reproduce
