// SPDX-License-Identifier: Apache-2.0
#include "cli/replay.h"

#include "cli/common_options.h"
#include "cli/progress.h"

#include <raycontact/error.h>
#include <recording/reader.h>
#include <recording/replay.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace raycontact;
using Json = nlohmann::ordered_json;

struct ReplayCommand {
    std::string file, compare;
    bool json = false;
    Settings settings;
};

Json median_and_p95(const std::vector<recording::ReplayStep>& steps, double recording::ReplayStep::*value) {
    std::vector<double> all;
    all.reserve(steps.size());
    for (const recording::ReplayStep& step : steps) all.push_back(step.*value);
    std::sort(all.begin(), all.end());
    const auto at = [&](double part) {
        return all.empty() ? 0 : all[static_cast<std::size_t>(part * static_cast<double>(all.size() - 1))];
    };
    return {{"median", at(0.5)}, {"p95", at(0.95)}};
}

Json summary(const recording::Reader& reader, const recording::Replay& replay, const Settings& settings,
             double wall_ms) {
    Json result{{"scene", reader.info().scene},
                {"seed", reader.info().seed},
                {"steps", reader.steps()},
                {"bodies", reader.info().bodies},
                {"pairs_max", replay.pairs_max},
                {"rays", replay.rays},
                {"contacts", replay.contacts},
                {"ray_length", replay.ray_length},
                {"penetration_max", replay.penetration_max},
                {"wall_ms", wall_ms},
                {"step_ms", median_and_p95(replay.steps, &recording::ReplayStep::step_ms)},
                {"narrow_ms", median_and_p95(replay.steps, &recording::ReplayStep::narrow_ms)},
                {"method", to_string(settings.method)},
                {"caster", to_string(settings.caster)},
                {"direction", to_string(settings.direction)},
                {"devices", Json::array({settings.device == "auto" ? "cpu" : settings.device})},
                {"hash", replay.hash},
                {"recorded_hash", nullptr},
                {"hash_reproduced", nullptr},
                {"complete", reader.hash().has_value()}};
    if (reader.hash()) {
        result["recorded_hash"] = *reader.hash();
        result["hash_reproduced"] = *reader.hash() == replay.hash;
    }
    if (replay.wrong_rays) {
        const recording::WrongRays& wrong = *replay.wrong_rays;
        result["wrong_rays"] = {{"total", wrong.total()},
                                {"missed", wrong.missed},
                                {"invented", wrong.invented},
                                {"other_triangle", wrong.other_triangle}};
        result["rays_compared"] = wrong.rays_compared;
        result["contacts_compared"] = wrong.contacts_compared;
    }
    return result;
}

std::string hash_for_a_person(const Json& s) {
    const auto hash = s["hash"].get<std::string>();
    if (s["recorded_hash"].is_null()) return hash + " (the recording was not finished, so it has none to compare with)";
    return hash
           + (s["hash_reproduced"].get<bool>() ? ", as recorded"
                                               : ", recorded was " + s["recorded_hash"].get<std::string>());
}

std::string for_a_person(const Json& s) {
    std::string text = fmt::format(
        "{}: {} bodies, {} steps, seed {}\n"
        "pairs      {} at most\n"
        "rays       {}, of them {} contacts, {:.1f} m in all\n"
        "depth      {:.4f} m at most\n"
        "time       {:.1f} s; step {:.2f} ms median, {:.2f} ms p95; narrow phase {:.2f} ms median\n"
        "hash       {}\n",
        s["scene"].get<std::string>(), s["bodies"].get<std::uint64_t>(), s["steps"].get<std::uint64_t>(),
        s["seed"].get<std::uint64_t>(), s["pairs_max"].get<std::uint64_t>(), s["rays"].get<std::uint64_t>(),
        s["contacts"].get<std::uint64_t>(), s["ray_length"].get<double>(), s["penetration_max"].get<double>(),
        s["wall_ms"].get<double>() / 1000, s["step_ms"]["median"].get<double>(), s["step_ms"]["p95"].get<double>(),
        s["narrow_ms"]["median"].get<double>(), hash_for_a_person(s));
    if (s.contains("wrong_rays")) {
        const Json& wrong = s["wrong_rays"];
        text +=
            fmt::format("wrong      {} of {} rays and {} contacts: {} missed, {} invented, {} on another triangle\n",
                        wrong["total"].get<std::uint64_t>(), s["rays_compared"].get<std::uint64_t>(),
                        s["contacts_compared"].get<std::uint64_t>(), wrong["missed"].get<std::uint64_t>(),
                        wrong["invented"].get<std::uint64_t>(), wrong["other_triangle"].get<std::uint64_t>());
    }
    return text;
}

void replay(const CLI::App& command, const ReplayCommand& given) {
    if (!given.compare.empty() && given.compare != "standard")
        throw InputError("--compare: \"" + given.compare + "\" is not known; only standard can be compared with");
    recording::Reader reader(given.file);
    recording::ReplayOptions options;
    options.settings = given.settings;
    options.compare = !given.compare.empty();
    // What decides the result is the recording's unless the command line says otherwise; where it runs is ours.
    const Settings& recorded = reader.info().settings;
    if (command.count("--method") == 0) options.settings.method = recorded.method;
    if (command.count("--caster") == 0) options.settings.caster = recorded.caster;
    if (command.count("--direction") == 0) options.settings.direction = recorded.direction;

    Progress progress("replay", reader.steps());
    options.progress = [&](std::uint32_t done) { progress.show(done); };
    const auto start = std::chrono::steady_clock::now();
    const recording::Replay result = recording::replay(reader, options);
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    progress.done();

    const Json json = summary(reader, result, options.settings, wall.count());
    if (json["hash_reproduced"] == false && options.settings.direction == recorded.direction
        && options.settings.method == recorded.method)
        std::cerr << "the recorded hash was not reproduced: these are other contacts than the run's\n";
    std::cout << (given.json ? json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n" : for_a_person(json));
}

} // namespace

void add_replay(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("replay", "Find the contacts of a recorded run again: the same poses and pairs");
    auto given = std::make_shared<ReplayCommand>();
    command->add_option("RECORDING", given->file, "a file made by `raycontact run --record`")->required();
    command
        ->add_option("--compare", given->compare, "standard: count the rays that end otherwise than with that method")
        ->type_name("METHOD");
    command->add_flag("--json", given->json, "print one JSON object on stdout");
    add_common_options(*command, given->settings);
    command->footer("Method, caster and direction are the recording's unless given.\n"
                    "Exit status: 0 fine, 1 the run failed, 2 bad usage or input.");
    command->callback([command, given] { replay(*command, *given); });
}
