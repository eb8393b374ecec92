// SPDX-License-Identifier: Apache-2.0
#include <reproduce/reproduce.h>

#include <raycontact/error.h>
#include <report/machine.h>
#include <reproduce/experiments.h>
#include <reproduce/page.h>
#include <reproduce/write_file.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string_view>

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
        const Json result = part->make([&](double cost) {
            done = std::min(done + cost, part->cost);
            options.progress(static_cast<std::uint32_t>(before + done));
        });
        shop.cache().keep(part->name, part->key,
                          {{"value", result}, {"machine", report::heading(report::this_machine())}});
        before += part->cost;
        options.progress(static_cast<std::uint32_t>(before));
    }
    options.end();
}

/// Headings that differ in their load alone become one, with its range.
std::vector<std::string> merged(const std::vector<std::string>& headings) {
    struct Merged {
        std::string before, after;
        std::string least, most; ///< the loads as they were printed
    };
    constexpr std::string_view mark = ", load ";
    std::vector<Merged> all;
    for (const std::string& heading : headings) {
        const std::size_t at = heading.find(mark);
        const std::size_t end = heading.find(';', std::min(at, heading.size()));
        if (end == std::string::npos) {
            all.push_back({heading, "", "", ""});
            continue;
        }
        const std::string load = heading.substr(at + mark.size(), end - at - mark.size());
        const std::string before = heading.substr(0, at + mark.size()), after = heading.substr(end);
        const auto same = std::find_if(all.begin(), all.end(),
                                       [&](const Merged& one) { return one.before == before && one.after == after; });
        if (same == all.end()) {
            all.push_back({before, after, load, load});
            continue;
        }
        if (std::strtod(load.c_str(), nullptr) < std::strtod(same->least.c_str(), nullptr)) same->least = load;
        if (std::strtod(load.c_str(), nullptr) > std::strtod(same->most.c_str(), nullptr)) same->most = load;
    }
    std::vector<std::string> texts;
    texts.reserve(all.size());
    for (const Merged& one : all)
        texts.push_back(one.before + one.least + (one.least == one.most ? "" : " to " + one.most) + one.after);
    return texts;
}

/// Nothing where a part was never run.
std::optional<Section> section(const Workshop& shop, const Experiment& experiment) {
    Section result{experiment.name, experiment.title, {}, {}};
    std::vector<Json> values;
    for (const Part& part : experiment.parts) {
        const auto entry = kept(shop, part);
        if (!entry) return std::nullopt;
        values.push_back(entry->at("value"));
        const auto machine = entry->at("machine").get<std::string>();
        if (std::find(result.machines.begin(), result.machines.end(), machine) == result.machines.end())
            result.machines.push_back(machine);
    }
    result.machines = merged(result.machines);
    result.outcome = experiment.show(values);
    if (!shop.plan().is_full())
        for (Number& number : result.outcome.numbers)
            number.why = "short version, less work than the paper's; " + number.why;
    return result;
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
