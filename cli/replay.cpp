// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/common_options.h"
#include "cli/out_option.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "cli/summary.h"

#include <output/out_folder.h>
#include <raycontact/error.h>
#include <recording/reader.h>
#include <recording/replay.h>
#include <report/counted.h>
#include <report/plot.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace raycontact;
using Json = nlohmann::ordered_json;

struct ReplayCommand {
    std::string file, compare, out;
    bool json = false;
    Settings settings;
};

Json summary(const recording::Reader& reader, const recording::Replay& replay, const Settings& settings,
             double wall_ms) {
    const Settings& recorded = reader.info().settings;
    const Work work(replay.steps);
    const bool cut_short = replay.steps.size() < reader.steps();
    const Json devices = work_of_devices(replay.steps);
    Json result{{"scene", reader.info().scene},
                {"seed", reader.info().seed},
                {"steps", replay.steps.size()},
                {"steps_planned", reader.steps()},
                {"cut_short", cut_short},
                {"bodies", reader.info().bodies},
                {"pairs_max", replay.pairs_max},
                {"rays", replay.rays},
                {"rays_cast", work.sum().details.rays_cast},
                {"contacts", replay.contacts},
                {"ray_length", replay.ray_length},
                {"penetration_max", replay.penetration_max},
                {"wall_ms", wall_ms},
                {"step_ms", median_and_p95(replay.steps, [](const recording::ReplayStep& r) { return r.step_ms; })},
                {"narrow_ms", median_and_p95(replay.steps, [](const recording::ReplayStep& r) { return r.narrow_ms; })},
                {"method", to_string(settings.method)},
                {"caster", to_string(settings.paper.caster)},
                {"direction", to_string(settings.direction)},
                {"features", to_string(settings.features)},
                {"devices", devices_of(devices)},
                {"device_choice", replay.device_choice},
                {"schedule", to_string(settings.execution.schedule)},
                {"work", devices},
                {"hash", replay.hash},
                {"recorded_hash", nullptr},
                {"hash_reproduced", nullptr},
                {"hash_expected", recording::must_agree(recorded, settings)},
                {"complete", reader.hash().has_value()}};
    if (reader.hash()) {
        result["recorded_hash"] = *reader.hash();
        if (!cut_short) result["hash_reproduced"] = *reader.hash() == replay.hash;
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
    result["recorded_method"] = to_string(recorded.method);
    result["recorded_direction"] = to_string(recorded.direction);
    result["recorded_features"] = to_string(recorded.features);
    work.put(result);
    put_settings(result, settings);
    return result;
}

std::string hash_for_a_person(const Json& s) {
    const auto hash = s["hash"].get<std::string>();
    if (s["recorded_hash"].is_null()) return hash + " (the recording was not finished, so it has none to compare with)";
    if (s["cut_short"].get<bool>()) return hash + ", of these steps alone";
    const auto recorded = s["recorded_method"].get<std::string>();
    const bool other_method = recorded != s["method"].get<std::string>();
    if (s["hash_reproduced"].get<bool>())
        return hash + ", as recorded" + (other_method ? " with method " + recorded : "");
    return hash + ", recorded was " + s["recorded_hash"].get<std::string>()
           + (s["hash_expected"].get<bool>()
                  ? ""
                  : fmt::format(" with other settings (method {}, direction {}, features {})", recorded,
                                s["recorded_direction"].get<std::string>(), s["recorded_features"].get<std::string>()));
}

std::string for_a_person(const Json& s) {
    std::string text = fmt::format(
        "{}: {}, {}, seed {}\n"
        "pairs      {} at most\n"
        "rays       {}, of them {} contacts, {:.1f} m in all\n"
        "depth      {} m at most\n"
        "time       {:.1f} s; step {:.2f} ms median, {:.2f} ms p95; narrow phase {:.2f} ms median\n",
        s["scene"].get<std::string>(), report::counted(s["bodies"].get<std::uint64_t>(), "body", "bodies"),
        report::counted(s["steps"].get<std::uint64_t>(), "step", "steps"), s["seed"].get<std::uint64_t>(),
        s["pairs_max"].get<std::uint64_t>(), s["rays"].get<std::uint64_t>(), s["contacts"].get<std::uint64_t>(),
        s["ray_length"].get<double>(), s["penetration_max"].get<double>(), s["wall_ms"].get<double>() / 1000,
        s["step_ms"]["median"].get<double>(), s["step_ms"]["p95"].get<double>(),
        s["narrow_ms"]["median"].get<double>());
    if (s["cut_short"].get<bool>())
        text += fmt::format("cut short  by {}: {} steps of {}\n", stop_name(), s["steps"].get<std::uint64_t>(),
                            s["steps_planned"].get<std::uint64_t>());
    text += work_for_a_person(s) + devices_for_a_person(s["work"], s["device_choice"].get<std::string>())
            + "hash       " + hash_for_a_person(s) + "\n";
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

std::string steps_csv(const std::vector<recording::ReplayStep>& steps, bool compared) {
    std::string text = std::string("step,pairs,")
                       + (compared ? "rays_compared,contacts_compared,missed,invented,other_triangle," : "")
                       + "narrow_ms" + work_columns() + ",rays,contacts\n";
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const recording::ReplayStep& r = steps[i];
        const recording::WrongRays& w = r.wrong;
        text += fmt::format("{},{},", i, r.pairs);
        if (compared)
            text += fmt::format("{},{},{},{},{},", w.rays_compared, w.contacts_compared, w.missed, w.invented,
                                w.other_triangle);
        text += fmt::format("{:.4f}{},{},{}\n", r.narrow_ms, work_cells(r), r.details.rays, r.contacts);
    }
    return text;
}

template <class Value>
void write_plot(output::OutFolder& folder, const recording::Reader& reader, const recording::Replay& replay,
                const std::string& name, report::Plot plot, Value value) {
    plot.over = report::over_steps(reader.info().dt);
    auto& points = plot.lines.front().points;
    for (const recording::ReplayStep& step : replay.steps) points.emplace_back(points.size(), value(step));
    folder.write(name, report::plot_svg({plot}));
}

void write_files(output::OutFolder& folder, const recording::Reader& reader, const recording::Replay& replay,
                 const Settings& settings) {
    const bool compared = replay.wrong_rays.has_value();
    const std::string how = "method " + std::string(to_string(settings.method));
    folder.write("steps.csv", steps_csv(replay.steps, compared));
    write_plot(folder, reader, replay, "narrow_ms.svg",
               {"Narrow phase", "ms", "Wall clock of contact finding, " + how + ", on this machine.", {{how, {}}}},
               [](const recording::ReplayStep& step) { return step.narrow_ms; });
    if (compared)
        write_plot(folder, reader, replay, "wrong_rays.svg",
                   {"Wrong rays",
                    "%",
                    "Rays of " + how
                        + " that end otherwise than those of method standard: a contact missed, invented or on another "
                          "triangle; of all rays that standard casts.",
                    {{how, {}}}},
                   [](const recording::ReplayStep& step) { return step.wrong.percent(); });
    folder.keep(replay.steps.size() < reader.steps());
}

void replay(const CLI::App& command, const ReplayCommand& given) {
    if (!given.compare.empty() && given.compare != "standard")
        throw InputError("--compare: \"" + given.compare + "\" is not known; only standard can be compared with");
    recording::Reader reader(given.file);
    recording::ReplayOptions options;
    options.settings = recorded_unless_given(command, given.settings, reader.info().settings);
    options.compare = !given.compare.empty();
    if (options.compare && options.settings.is_speculative())
        throw InputError("--compare: speculative contacts have no rays to compare; leave --speculative out");
    if (options.compare && (options.settings.max_contacts_per_pair != 0 || options.settings.max_contacts != 0))
        throw InputError("--compare: the rays of all contacts are compared, and here some are left out; add "
                         "--max-contacts-per-pair 0 --max-contacts 0");
    std::optional<output::OutFolder> folder;
    if (!given.out.empty()) {
        folder.emplace(given.out);
        for (const char* name : {"steps.csv", "narrow_ms.svg", "wrong_rays.svg"}) folder->claim(name);
        name_left_overs(folder->left_overs());
    }

    Progress progress("replay", reader.steps());
    options.progress = [&](std::uint32_t done) { progress.show(done); };
    options.stop = [] { return stop_signal() != 0; };
    listen_for_stop();
    const auto start = std::chrono::steady_clock::now();
    const recording::Replay result = recording::replay(reader, options);
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    progress.done();

    const Json json = summary(reader, result, options.settings, wall.count());
    std::string error; // told last
    try {
        if (folder) write_files(*folder, reader, result, options.settings);
    } catch (const std::exception& unwritten) {
        error = unwritten.what();
    }
    std::cout << (given.json ? json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n" : for_a_person(json))
              << std::flush;
    if (!error.empty()) throw std::runtime_error(error);
    if (json["hash_reproduced"] == false && json["hash_expected"] == true) {
        throw std::runtime_error(given.file
                                 + ": the recorded hash was not reproduced: these are other contacts than the run's");
    }
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
    add_out(*command, "--out", given->out,
            "write steps.csv and narrow_ms.svg there; with --compare also wrong_rays.svg, the percentage of "
            "wrong rays in each step")
        ->type_name("DIR");
    command->add_flag("--json", given->json, "print one JSON object on stdout");
    add_common_options(*command, given->settings);
    add_speculative_option(*command, given->settings);
    command->footer(
        "What decides the contacts (method, caster, direction, features, thresholds) is the recording's unless given.\n"
        "Methods standard and certified find the same contacts, so either reproduces the other's hash.\n"
        "A hash that should have been reproduced and was not is a failed run.\n"
        + std::string(stop_footer));
    command->callback([command, given] { replay(*command, *given); });
}
