// SPDX-License-Identifier: Apache-2.0
#include "cli/summary.h"

#include <report/counted.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

using namespace raycontact;
using Json = nlohmann::ordered_json;

namespace {

struct Count {
    constexpr Count(const char* as, std::uint64_t StepStats::*value) : name(as), stat(value) {}
    constexpr Count(const char* as, std::uint64_t StepDetails::*value) : name(as), detail(value) {}

    std::uint64_t of(const StepStats& step) const { return stat != nullptr ? step.*stat : step.details.*detail; }
    std::uint64_t& of(StepStats& step) const { return stat != nullptr ? step.*stat : step.details.*detail; }

    const char* name;
    std::uint64_t StepStats::*stat = nullptr;
    std::uint64_t StepDetails::*detail = nullptr;
};

/// In the order of steps.csv.
constexpr Count counts[] = {
    {"rays_cast", &StepDetails::rays_cast},
    {"walks", &StepDetails::walks},
    {"walks_lost", &StepDetails::walks_lost},
    {"walk_casts", &StepDetails::walk_casts},
    {"predictions", &StepDetails::predictions},
    {"pairs_full", &StepDetails::pairs_full},
    {"pairs_skipped", &StepDetails::pairs_skipped},
    {"pairs_as_standard", &StepDetails::pairs_as_standard},
    {"pair_bytes", &StepStats::pair_bytes},
    {"contacts_new", &StepStats::contacts_new},
    {"contacts_lost", &StepStats::contacts_lost},
    {"contacts_speculative", &StepStats::contacts_speculative},
    {"contacts_reduced", &StepStats::contacts_reduced},
    {"pairs_moved", &StepDetails::pairs_moved},
    {"bytes_moved", &StepDetails::bytes_moved},
    {"devices_lost", &StepStats::devices_lost},
};

bool is_memory(const Count& count) {
    return count.stat == &StepStats::pair_bytes;
}

Json length(const std::optional<double>& metres) {
    return metres ? Json(*metres) : Json(nullptr);
}

} // namespace

void Work::add(const StepStats& step) {
    sum_.pairs = std::max(sum_.pairs, step.pairs);
    sum_.contacts += step.contacts;
    sum_.details.rays += step.details.rays;
    sum_.details.ray_length += step.details.ray_length;
    for (const Count& count : counts) {
        std::uint64_t& sum = count.of(sum_);
        sum = is_memory(count) ? std::max(sum, count.of(step)) : sum + count.of(step);
    }
}

void Work::put(Json& object) const {
    for (const Count& count : counts) object[is_memory(count) ? "pair_bytes_max" : count.name] = count.of(sum_);
}

// As the option --speculative takes it.
Json speculative_word(const Settings& settings) {
    if (!settings.is_speculative()) return "off";
    return settings.speculative_margin ? Json(*settings.speculative_margin) : Json("auto");
}

void put_settings(Json& object, const Settings& settings) {
    object["displacement_threshold"] = length(settings.paper.displacement_threshold);
    object["confidence"] = settings.paper.confidence;
    object["culling_distance"] = length(settings.paper.culling_distance);
    object["distance_extension"] = length(settings.paper.distance_extension);
    object["max_iterations"] = settings.paper.max_iterations;
    object["cast_lost_walks"] = settings.paper.cast_lost_walks;
    object["speculative"] = speculative_word(settings);
    object["max_contacts_per_pair"] = settings.max_contacts_per_pair;
    object["max_contacts"] = settings.max_contacts;
}

std::string work_for_a_person(const Json& s) {
    const auto count = [&](const char* key) { return s.at(key).get<std::uint64_t>(); };
    std::string text =
        fmt::format("work       {} rays cast in full; directed pairs: {} times tested in full, {} times skipped\n",
                    count("rays_cast"), count("pairs_full"), count("pairs_skipped"));
    if (count("walks") > 0 || count("predictions") > 0)
        text += fmt::format("walks      {}, of them {} ended nowhere, {} of those cast in full; {} predictions\n",
                            count("walks"), count("walks_lost"), count("walk_casts"), count("predictions"));
    return text
           + fmt::format("changes    {} came, {} went; {:.3g} MB kept for pairs at most\n",
                         report::counted(count("contacts_new"), "contact", "contacts"), count("contacts_lost"),
                         static_cast<double>(count("pair_bytes_max")) / 1e6);
}

Json devices_of(const Json& list) {
    Json ids = Json::array();
    for (const Json& entry : list) ids.push_back(entry.at("device"));
    return ids;
}

std::string devices_for_a_person(const Json& list, const std::string& choice) {
    std::string text = "devices    " + choice + "\n";
    for (const Json& entry : list) {
        const auto median = [&](const char* key) { return entry.at(key).at("median").get<double>(); };
        const auto counted = [&](const char* key, const char* one, const char* many) {
            return report::counted(static_cast<std::uint64_t>(std::llround(median(key))), one, many);
        };
        text += fmt::format("device     {}: {}, load {:.0f}, {}, {}, {:.3g} kB up and {:.3g} kB down, busy for "
                            "{:.2f} ms of {:.2f} a step (medians)\n",
                            entry.at("device").get<std::string>(), counted("pairs", "pair", "pairs"), median("load"),
                            counted("launches", "launch", "launches"), counted("reads", "read", "reads"),
                            median("bytes_up") / 1e3, median("bytes_down") / 1e3, median("busy_ms"), median("ms"));
    }
    return text;
}

std::string work_columns() {
    std::string text;
    for (const Count& count : counts) text += std::string(",") + count.name;
    return text;
}

std::string work_cells(const StepStats& step) {
    std::string text;
    for (const Count& count : counts) text += fmt::format(",{}", count.of(step));
    return text;
}
