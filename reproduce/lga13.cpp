// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>
#include <reproduce/phases.h>
#include <reproduce/series.h>

#include <fmt/format.h>

#include <algorithm>

namespace raycontact::reproduce {

namespace {

constexpr const char* scene = "avalanche";

/// The first two cast every ray of a full test, as the paper's do; the others are spared some by the library's grids.
std::vector<Settings> contestants(const Plan& plan, Caster caster) {
    std::vector<Settings> all{as_in_the_paper(Method::iterative, plan.constants), by_default(Method::standard)};
    all[1].paper.skip_outside = false;
    if (caster == Caster::bvh) {
        for (std::size_t k = 0; k < 2; ++k) {
            all.push_back(all[k]);
            all.back().paper.skip_outside = true;
        }
    }
    for (Settings& settings : all) settings.paper.caster = caster;
    return all;
}

Json measure(const Workshop& shop, Caster caster, const Tick& tick) {
    const auto file = shop.recording(shop.base(scene));
    std::vector<Follow> follow;
    for (const Settings& settings : contestants(shop.plan(), caster)) follow.push_back({file, settings});
    Json result = Json::array();
    for (std::size_t k = 0; k < follow.size(); ++k) result.push_back(Json::array());
    side_by_side(follow, [&](std::uint32_t, std::span<Scene* const> scenes) {
        for (std::size_t k = 0; k < scenes.size(); ++k) result[k].push_back(scenes[k]->stats().narrow_ms);
        tick(1.0 / shop.plan().avalanche.steps);
    });
    return result;
}

Outcome show(const std::vector<Json>& found) {
    Outcome out;
    Table table{"standard against iterative", {"caster", "standard", "best second", "mean"}, {}};
    for (std::size_t k = 0; k < found.size(); ++k) {
        const bool basic = k == 0;
        const auto iterative = found[k][0].get<Series>(), standard = found[k][1].get<Series>();
        const double best = best_second(standard, iterative), mean = sum(standard) / std::max(sum(iterative), 1e-9);
        const std::string caster = basic ? "basic" : "bvh";
        table.rows.push_back({caster, "every ray cast", fmt::format("{:.1f}", best), fmt::format("{:.1f}", mean)});
        report::Plot plot{
            "LGA13: time, caster " + caster,
            "ms",
            fmt::format(
                "The paper: iterative up to 33 times as fast; here {:.1f} in the best second, {:.1f} over all steps.",
                best, mean),
            {line("standard", standard), line("iterative", iterative)},
            report::over_steps(1.0 / 60)};
        if (!basic) {
            const auto spared = found[k][2].get<Series>(), grids = found[k][3].get<Series>();
            plot.lines.push_back(line("standard with grids", grids));
            plot.lines.push_back(line("iterative with grids", spared));
            table.rows.push_back({caster, "both with this library's grids",
                                  fmt::format("{:.1f}", best_second(grids, spared)),
                                  fmt::format("{:.1f}", sum(grids) / std::max(sum(spared), 1e-9))});
        }
        out.plots.push_back(plot);
        if (basic)
            out.numbers.push_back(compared(
                "lga13", 33, best, "times as fast", Better::higher,
                fmt::format(
                    "best second of the avalanche, caster basic, constants fixed, both cast every ray; mean {:.1f}. It "
                    "grows as the pile comes to rest and fewer pairs are tested in full: {:.1f} in the first second, "
                    "{:.1f} in the last. The paper says \"up to\", on a GPU and a scene that it does not name",
                    mean, of_second(standard, iterative, 0),
                    of_second(standard, iterative, standard.size() - std::min(standard.size(), second)))));
    }
    out.tables.push_back(table);
    out.paragraphs = {
        "Both methods follow the same recording with the same caster. standard casts every ray in full in every step; "
        "iterative has the fixed constants of Figure 9 and casts every ray of a full test."};
    return out;
}

} // namespace

Experiment lga13(const Workshop& shop) {
    Experiment e;
    e.name = "lga13";
    e.title = "LGA13: iterative against standard";
    for (const Caster caster : {Caster::basic, Caster::bvh}) {
        Json settings;
        for (const Settings& one : contestants(shop.plan(), caster)) settings["methods"].push_back(to_json(one));
        const double cost = Workshop::cost(shop.base(scene)) * (caster == Caster::basic ? 5 : 0.7);
        e.parts.push_back({fmt::format("lga13-{}", to_string(caster)), shop.key("lga13", settings), cost,
                           [&shop, caster](const Tick& tick) { return measure(shop, caster, tick); }});
    }
    e.show = show;
    return e;
}

} // namespace raycontact::reproduce
