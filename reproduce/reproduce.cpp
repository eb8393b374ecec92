// SPDX-License-Identifier: Apache-2.0
#include <reproduce/reproduce.h>

#include <raycontact/error.h>
#include <report/machine.h>
#include <reproduce/experiments.h>
#include <reproduce/page.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace raycontact::reproduce {

namespace {

/// What is kept of a part: its result, and on which machine and when it was made.
std::optional<Json> kept(const Workshop& shop, const Part& part) {
    return shop.cache().find(part.name, part.key);
}

void run(const Workshop& shop, const Experiment& experiment, const Options& options) {
    double total = 0;
    std::vector<const Part*> missing;
    for (const Part& part : experiment.parts)
        if (!kept(shop, part)) {
            missing.push_back(&part);
            total += part.cost;
        }
    options.begin(experiment.name, static_cast<std::uint32_t>(std::min(total, 4e9)));
    double before = 0;
    for (const Part* part : missing) {
        double done = 0;
        const Json result = part->make([&](double share) {
            done = std::min(done + share * part->cost, part->cost);
            options.progress(static_cast<std::uint32_t>(before + done));
        });
        const report::Machine machine = report::this_machine();
        std::string heading = report::heading(machine, false);
        heading.pop_back(); // the line's end
        shop.cache().keep(part->name, part->key, {{"value", result}, {"machine", heading}, {"load", machine.load}});
        before += part->cost;
        options.progress(static_cast<std::uint32_t>(before));
    }
    options.end();
}

/// Nothing where a part was never run.
std::optional<Section> section(const Workshop& shop, const Experiment& experiment) {
    Section result{experiment.name, experiment.title, {}, {}};
    std::vector<Json> values;
    std::map<std::string, std::pair<double, double>> loads; // least and most, by machine
    for (const Part& part : experiment.parts) {
        const auto entry = kept(shop, part);
        if (!entry) return std::nullopt;
        values.push_back(entry->at("value"));
        const auto load = entry->at("load").get<double>();
        auto& [least, most] = loads.try_emplace(entry->at("machine").get<std::string>(), load, load).first->second;
        std::tie(least, most) = std::pair(std::min(least, load), std::max(most, load));
    }
    for (const auto& [machine, load] : loads)
        result.machines.push_back(fmt::format("{}, load {:.2f}{}", machine, load.first,
                                              load.first < load.second ? fmt::format(" to {:.2f}", load.second) : ""));
    result.outcome = experiment.show(values);
    if (!shop.plan().is_full())
        for (Number& number : result.outcome.numbers)
            number.why = "short version, less work than the paper's; " + number.why;
    return result;
}

/// In the order of the paper.
std::vector<Experiment> all_experiments(const Workshop& shop) {
    std::vector<Experiment> all;
    const std::vector<std::string> scenes = scene_names();
    all.push_back(table1(shop));
    for (const std::string& scene : scenes) all.push_back(wrong_rays(shop, scene));
    all.push_back(lengths(shop));
    all.push_back(volumes(shop));
    for (const std::string& scene : scenes) all.push_back(times(shop, scene));
    all.push_back(table2(shop));
    for (const std::string& scene : scenes) all.push_back(two_devices(shop, scene));
    all.push_back(lga13(shop));
    return all;
}

} // namespace

std::vector<std::string> experiment_names() {
    return {"all",   "fig9",   "fig10",  "fig11",   "fig12",  "fig14",
            "fig15", "table1", "table2", "lengths", "volume", "lga13"};
}

std::vector<Number> reproduce(const Options& options) {
    const std::vector<std::string> names = experiment_names();
    if (std::find(names.begin(), names.end(), options.what) == names.end()) {
        std::string known;
        for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
        throw InputError("reproduce: \"" + options.what + "\" is not known; known are " + known);
    }
    const Workshop shop(options.plan, options.out / "cache");
    const std::vector<Experiment> all = all_experiments(shop);
    for (const Experiment& experiment : all)
        if (options.what == "all" || options.what == experiment.name) run(shop, experiment, options);
    Page page{options.plan, {}, {}};
    std::vector<Number> numbers;
    for (const Experiment& experiment : all) {
        if (auto part = section(shop, experiment)) {
            numbers.insert(numbers.end(), part->outcome.numbers.begin(), part->outcome.numbers.end());
            page.sections.push_back(std::move(*part));
        } else {
            page.not_run.push_back(experiment.name);
        }
    }
    for (const Section& one : page.sections)
        if (one.name == options.what && options.table)
            for (const Table& table : one.outcome.tables) options.table(table);
    write_whole(options.out / "results.json", to_json(numbers).dump(1) + "\n");
    write_whole(options.out / "report.html", make_page(page));
    return numbers;
}

} // namespace raycontact::reproduce
