// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>
#include <reproduce/series.h>

#include <raycontact/clash.h>
#include <raycontact/collide.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace raycontact::reproduce {

namespace {

constexpr const char* scene = "avalanche";

struct Run {
    const char* name;
    SimulationOptions options;
};

/// The runs of section 5.2 and of Table 2, and the latter with speculative contacts. Bullet takes no weights: with
/// `weighted` it would run as with `ray`, so that is a measure alone.
std::vector<Run> runs(const Workshop& shop) {
    std::vector<Run> all;
    const auto add = [&](const char* name, const Settings& settings, bool speculative) {
        all.push_back({name, {scene, 1, shop.plan().size(scene), settings, true, speculative}});
    };
    add("iterative", as_in_the_paper(Method::iterative, shop.plan().constants), false);
    add("predictive", as_in_the_paper(Method::predictive, shop.plan().constants), false);
    Settings exact = by_default(Method::certified);
    add("reprojected", exact, false);
    add("reprojected, speculative", exact, true);
    exact.direction = Direction::ray;
    add("ray", exact, false);
    add("ray, speculative", exact, true);
    return all;
}

/// What is measured by the contacts of `standard`: |r|, r . n, and |r| times the area of its vertex, which is a volume.
constexpr const char* measures[] = {"ray", "reprojected", "weighted"};

using Sums = std::map<Pair, double>;

/// Of each pair of bodies that share a volume or have a contact: {"steps": the sampled ones, "ray", "reprojected",
/// "weighted", "volume": sums over the pairs, a number a sampled step; "of_pairs": the correlation of each measure with
/// the volume, over all pairs of all sampled steps; "unseen": how many have a volume and no contact, and
/// "unseen_volume"}.
Json measure(const Workshop& shop, const SimulationOptions& options, const Tick& tick) {
    const auto file = shop.recording(options, [&](double share) { tick(share / 3); });
    Settings weighted = by_default(Method::standard), reprojected = weighted;
    weighted.direction = Direction::weighted;
    Json result{{"steps", Json::array()}, {"volume", Json::array()}};
    std::map<std::string, Series> of_pairs;
    std::uint64_t unseen = 0, pairs_met = 0;
    double unseen_volume = 0;
    side_by_side({{file, weighted}, {file, reprojected}}, [&](std::uint32_t step, std::span<Scene* const> scenes) {
        tick(2.0 / 3 / options.size.steps);
        if ((step + 1) % shop.plan().volume_every != 0) return;
        const Scene& placed = *scenes[0];
        std::map<std::string, Sums> found;
        const auto add = [](Sums& sums, const Contact& contact, double value) {
            sums[{contact.body_a, contact.body_b}] += value;
        };
        for (const Contact& contact : placed.contacts()) {
            const double length = static_cast<double>(contact.ray_length);
            add(found["ray"], contact, length);
            add(found["weighted"], contact, length * static_cast<double>(contact.weight));
        }
        for (const Contact& contact : scenes[1]->contacts())
            add(found["reprojected"], contact, static_cast<double>(contact.depth));
        Series totals(std::size(measures));
        double volume_of_all = 0;
        for (const Pair& pair : placed.pairs()) {
            const auto& [a, b] = pair;
            const bool seen = found["ray"].contains(pair);
            if (!seen && !intersects(placed.shape(a), placed.pose(a), placed.shape(b), placed.pose(b))) continue;
            const double volume =
                overlap_volume(placed.shape(a), placed.pose(a), placed.shape(b), placed.pose(b));
            volume_of_all += volume;
            ++pairs_met;
            unseen += !seen;
            unseen_volume += seen ? 0 : volume;
            of_pairs["volume"].push_back(volume);
            for (std::size_t k = 0; k < std::size(measures); ++k) {
                const double value = found[measures[k]][pair];
                totals[k] += value;
                of_pairs[measures[k]].push_back(value);
            }
        }
        result["steps"].push_back(step + 1);
        result["volume"].push_back(volume_of_all);
        for (std::size_t k = 0; k < std::size(measures); ++k) result[measures[k]].push_back(totals[k]);
    });
    for (const char* one : measures) result["of_pairs"][one] = rank_correlation(of_pairs[one], of_pairs["volume"]);
    result["pairs"] = pairs_met;
    result["unseen"] = unseen;
    result["unseen_volume"] = unseen_volume;
    // lengths keeps those of the paper's methods.
    if (options.settings.method == Method::certified) shop.drop_recording(options);
    return result;
}

Outcome show(const std::vector<Run>& all, const std::vector<Json>& found) {
    Outcome out;
    Table sums{"Cumulative length and volume over the sampled steps, avalanche, seed 1",
               {"run", "ray", "reprojected", "ray x area", "volume",
                "rank correlation over steps (ray, reprojected, ray x area)", "over pairs", "pairs without a contact",
                "their volume"},
               {}};
    Table steps{"Sampled steps: length of the rays, volume of overlap", {"step"}, {}};
    report::Plot lengths{"Length of the rays of standard", "m", "Sampled steps.", {}, "step"};
    report::Plot volumes{"Volume of overlap", "litres", "Sampled steps.", {}, "step"};
    for (std::size_t i = 0; i < found[0]["steps"].size(); ++i) steps.rows.push_back({found[0]["steps"][i].dump()});
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Json& of = found[k];
        const auto volume = of["volume"].get<Series>();
        std::vector<std::string> row{all[k].name};
        std::string over_steps, over_pairs;
        for (const char* one : measures) {
            const auto values = of[one].get<Series>();
            const bool is_volume = one == std::string("weighted");
            row.push_back(is_volume ? fmt::format("{:.2f} l", 1000 * sum(values))
                                    : fmt::format("{:.2f} m", sum(values)));
            over_steps += fmt::format("{}{:.2f}", over_steps.empty() ? "" : ", ", rank_correlation(values, volume));
            over_pairs += fmt::format("{}{:.2f}", over_pairs.empty() ? "" : ", ", of["of_pairs"][one].get<double>());
        }
        row.push_back(fmt::format("{:.2f} l", 1000 * sum(volume)));
        row.push_back(over_steps);
        row.push_back(over_pairs);
        row.push_back(fmt::format("{} of {}", of["unseen"].dump(), of["pairs"].dump()));
        row.push_back(percent(share(of["unseen_volume"].get<double>(), sum(volume)), 2));
        sums.rows.push_back(row);
        steps.head.push_back(std::string(all[k].name) + ", m");
        steps.head.push_back("l");
        const auto length = of["ray"].get<Series>();
        report::Line by_length{all[k].name, {}}, by_volume{all[k].name, {}};
        for (std::size_t i = 0; i < volume.size(); ++i) {
            steps.rows[i].push_back(fmt::format("{:.3f}", length[i]));
            steps.rows[i].push_back(fmt::format("{:.3f}", 1000 * volume[i]));
            by_length.points.emplace_back(of["steps"][i].get<double>(), length[i]);
            by_volume.points.emplace_back(of["steps"][i].get<double>(), 1000 * volume[i]);
        }
        lengths.lines.push_back(by_length);
        volumes.lines.push_back(by_volume);
    }
    // Two runs, the one with the shorter rays first: a negative share of volume is a disagreement.
    Table order{"Two runs, by length and by volume",
                {"run", "against", "shorter rays", "less volume", "sampled steps in another order"},
                {}};
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t k = 0; k < all.size(); ++k) {
            const auto length = found[i]["ray"].get<Series>(), other_length = found[k]["ray"].get<Series>();
            const auto volume = found[i]["volume"].get<Series>(), other_volume = found[k]["volume"].get<Series>();
            if (!(sum(length) < sum(other_length))) continue;
            std::size_t otherwise = 0;
            for (std::size_t at = 0; at < length.size(); ++at)
                otherwise += (length[at] < other_length[at] && volume[at] > other_volume[at])
                             || (length[at] > other_length[at] && volume[at] < other_volume[at]);
            order.rows.push_back({all[i].name, all[k].name, percent(less_by(sum(other_length), sum(length))),
                                  percent(less_by(sum(other_volume), sum(volume))),
                                  fmt::format("{} of {}", otherwise, length.size())});
        }
    out.plots = {lengths, volumes};
    out.tables = {sums, order, steps};
    out.paragraphs = {
        "The paper takes the cumulative length of all rays for the amount of interpenetration (section 5.2). Here the "
        "volume that bodies share stands beside it, summed over all pairs, on sampled steps of several runs. It is "
        "exact but for rounding. The rays are those of standard along the poses of each run, before re-projection "
        "(ray), after it, and times the area of their vertex, which is a volume, too.",
        "A negative share of volume means that length and volume put two runs in another order. Rank correlation is "
        "Spearman's: over the sampled steps of a run, and over all pairs of bodies in all of them. Pairs without a "
        "contact share a volume, but have no vertex in each other by the paper's rule."};
    return out;
}

} // namespace

Experiment volumes(const Workshop& shop) {
    Experiment e;
    e.name = "volume";
    e.title = "Section 5.2: the length of the rays beside the volume of overlap";
    const std::vector<Run> all = runs(shop);
    for (const Run& run : all) {
        Json key = shop.key("volume", run.options);
        key["settings"]["every"] = shop.plan().volume_every;
        e.parts.push_back({"volume-" + std::to_string(e.parts.size()), key, 3 * Workshop::cost(run.options),
                           [&shop, options = run.options](const Tick& tick) { return measure(shop, options, tick); }});
    }
    e.show = [all](const std::vector<Json>& found) { return show(all, found); };
    return e;
}

} // namespace raycontact::reproduce
