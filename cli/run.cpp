// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/common_options.h"
#include "cli/gimpact_turns.h"
#include "cli/out_option.h"
#include "cli/progress.h"
#include "cli/record.h"
#include "cli/run_scene.h"
#include "cli/stop.h"
#include "cli/summary.h"

#include <output/out_folder.h>
#include <raycontact/error.h>
#include <report/counted.h>
#include <report/report.h>
#include <scenes/simulation.h>
#include <view/view.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Json = nlohmann::ordered_json;
using raycontact::InputError;
using raycontact::report::counted;
using namespace raycontact::scenes;

struct RunOptions {
    RunScene scene;
    std::string out, record;
    bool no_view = false, json = false;
    raycontact::Settings settings;
};

Json count(const std::optional<std::uint32_t>& bodies) {
    return bodies ? Json(*bodies) : Json(nullptr);
}

Json summary(const RunOptions& options, const Simulation& scene, double wall_ms) {
    using raycontact::to_string;
    const Health health = scene.health();
    const RunLog& log = scene.log();
    const Work work(log.rows);
    const raycontact::StepStats& sum = work.sum();
    const auto second = static_cast<std::ptrdiff_t>(std::min<std::size_t>(steps_of_a_second(log.dt), log.rows.size()));
    const std::vector<StepRow> last_second(log.rows.end() - second, log.rows.end());
    const Json devices = work_of_devices(log.rows);
    Json result{
        {"scene", log.scene},
        {"seed", log.seed},
        {"steps", scene.steps()},
        {"steps_planned", scene.description().steps},
        {"cut_short", scene.steps() < scene.description().steps},
        {"bodies", scene.body_count()},
        {"pairs_max", sum.pairs},
        {"rays", sum.details.rays},
        {"rays_cast", sum.details.rays_cast},
        {"contacts", sum.contacts},
        {"ray_length", sum.details.ray_length},
        {"penetration_max", health.penetration_max},
        {"wall_ms", wall_ms},
        {"step_ms", median_and_p95(log.rows, [](const StepRow& r) { return r.step_ms; })},
        {"narrow_ms", median_and_p95(log.rows, [](const StepRow& r) { return r.narrow_ms; })},
        {"narrow_ms_last_second", quantile(last_second, 0.5, [](const StepRow& r) { return r.narrow_ms; })},
        {"method", to_string(options.settings.method)},
        {"caster", to_string(options.settings.paper.caster)},
        {"direction", to_string(options.settings.direction)},
        {"features", to_string(options.settings.features)},
        {"devices", devices_of(devices)},
        {"device_choice", scene.scene().device_choice()},
        {"schedule", to_string(options.settings.execution.schedule)},
        {"work", devices},
        {"hash", scene.hash()},
        {"mesh_source", log.mesh_source},
        {"pairs_last_second", quantile(last_second, 0.5, [](const StepRow& r) { return double(r.pairs); })},
        {"median_speed_last_second", health.median_speed_last_second},
        {"penetration_max_last_second", quantile(last_second, 1, [](const StepRow& r) { return r.penetration_max; })},
        {"depth_limit", health.depth_limit},
        {"deep_contacts", health.deep_contacts},
        {"deep_steps_longest", health.deep_steps_longest},
        {"deep_steps_last_second", health.deep_steps_last_second},
        {"below_ground", count(health.below_ground)},
        {"flown_off", count(health.flown_off)}};
    work.put(result);
    put_settings(result, options.settings);
    return result;
}

std::string whereabouts(const Json& s) {
    if (s["below_ground"].is_null()) return "no ground that bodies could fall from";
    return counted(s["below_ground"].get<std::uint64_t>(), "body", "bodies") + " below ground, "
           + std::to_string(s["flown_off"].get<std::uint64_t>()) + " flown off";
}

std::string for_a_person(const Json& s) {
    std::string text = fmt::format(
        "{}: {}, {}, seed {}; {}\n"
        "pairs      {} at most, {} in the last second\n"
        "rays       {}, of them {} contacts, {:.1f} m in all\n"
        "depth      {} m at most, {} m in the last second\n"
        "speed      median {:.4f} m/s in the last second; {}\n"
        "time       {:.1f} s; step {:.2f} ms median, {:.2f} ms p95; narrow phase {:.2f} ms median, {:.2f} ms in the "
        "last second\n",
        s["scene"].get<std::string>(), counted(s["bodies"].get<std::uint64_t>(), "body", "bodies"),
        counted(s["steps"].get<std::uint64_t>(), "step", "steps"), s["seed"].get<std::uint64_t>(),
        s["mesh_source"].get<std::string>(), s["pairs_max"].get<std::uint64_t>(), s["pairs_last_second"].get<double>(),
        s["rays"].get<std::uint64_t>(), s["contacts"].get<std::uint64_t>(), s["ray_length"].get<double>(),
        s["penetration_max"].get<double>(), s["penetration_max_last_second"].get<double>(),
        s["median_speed_last_second"].get<double>(), whereabouts(s), s["wall_ms"].get<double>() / 1000,
        s["step_ms"]["median"].get<double>(), s["step_ms"]["p95"].get<double>(), s["narrow_ms"]["median"].get<double>(),
        s["narrow_ms_last_second"].get<double>());
    if (s["cut_short"].get<bool>())
        text += fmt::format("cut short  by {}: {} steps of {}\n", stop_name(), s["steps"].get<std::uint64_t>(),
                            s["steps_planned"].get<std::uint64_t>());
    return text + work_for_a_person(s) + devices_for_a_person(s["work"], s["device_choice"].get<std::string>())
           + "hash       " + s["hash"].get<std::string>() + "\n";
}

std::string steps_csv(const std::vector<StepRow>& rows) {
    std::string text = "step,pairs,rays,contacts,step_ms,narrow_ms,ray_length_m,penetration_max_m,median_speed_m_s"
                       + work_columns() + "\n";
    for (const StepRow& r : rows)
        text +=
            fmt::format("{},{},{},{},{:.4f},{:.4f},{},{},{}{}\n", r.step, r.pairs, r.details.rays, r.contacts,
                        r.step_ms, r.narrow_ms, r.details.ray_length, r.penetration_max, r.median_speed, work_cells(r));
    return text;
}

/// Viewers go by the ending, and a recording under another name overwrites what nobody meant.
void check_record(const std::string& file) {
    std::string ending = std::filesystem::path(file).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    if (ending != ".glb") throw InputError("--record: \"" + file + "\" does not end in .glb; name a .glb file");
}

/// All that the run is to write, claimed before its first step.
struct Outputs {
    explicit Outputs(const RunOptions& options) {
        if (!options.record.empty()) {
            recording.emplace(options.record);
            name_left_overs(recording->left_overs());
        }
        if (options.out.empty()) return;
        folder.emplace(options.out);
        folder->claim("steps.csv");
        raycontact::report::claim_report(*folder);
        name_left_overs(folder->left_overs());
    }
    std::optional<raycontact::output::OutFile> recording;
    std::optional<raycontact::output::OutFolder> folder;
};

/// With the last step's poses, where the run was cut short before that of its plan.
RunLog log_of(const Simulation& scene, const std::string& summary_json) {
    RunLog log = scene.log();
    log.summary_json = summary_json;
    if (log.rows.size() < scene.description().steps && log.frames.back().step != log.rows.back().step) {
        Frame& last = log.frames.emplace_back();
        last.step = log.rows.back().step;
        last.poses = scene.poses();
    }
    return log;
}

/// run: null for a report without a view.
void write_files(raycontact::output::OutFolder& folder, const RunLog& log, const raycontact::view::RunView* run,
                 const raycontact::Settings& settings, bool cut_short) {
    const auto start = std::chrono::steady_clock::now();
    folder.write("steps.csv", steps_csv(log.rows));
    const std::string view = run ? make_view(log, *run, settings).html : "";
    raycontact::report::write_report(folder, log, view, compare_with_gimpact(log));
    folder.keep(cut_short);
    const std::filesystem::path page = folder.kept("report.html");
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cerr << fmt::format("report: {}, {:.1f} MB, made in {:.1f} s\n", page.string(),
                             static_cast<double>(std::filesystem::file_size(page)) / 1e6, seconds.count());
}

/// Bodies pass an open mesh that come from behind its faces, and one whose faces disagree anywhere.
void warn_if_open(const SceneDescription& scene, const BodyStart& body) {
    const raycontact::Shape& shape = *scene.shapes[body.shape].shape;
    const raycontact::MeshReport& report = shape.report();
    if (report.solid) return;
    std::string what = "badly wound: faces at an edge disagree on which side is out; turn some over";
    if (report.closed && report.oriented) what = "hollow: walls back to back that hold nothing, which bodies pass";
    if (!report.closed) {
        what = fmt::format("open, with {}: bodies that come from behind its faces pass it",
                           counted(report.border_edges, "border edge", "border edges"));
        // Areas that face the way of gravity, and against it; in the body's frame.
        const auto vector = [](const raycontact::Vec3& p, const raycontact::Vec3& from) {
            return btVector3(btScalar(p.x - from.x), btScalar(p.y - from.y), btScalar(p.z - from.z));
        };
        const btVector3 gravity = vector(scene.gravity, {}) * body.pose.getBasis();
        const auto place = shape.vertices();
        double down = 0, up = 0;
        for (const auto& [a, b, c] : shape.triangles()) {
            const double along = vector(place[b], place[a]).cross(vector(place[c], place[a])).dot(gravity);
            (along > 0 ? down : up) += std::fabs(along);
        }
        if (down > 2 * up) what += "; its faces look down, so what falls on it falls through: turn them over";
    }
    std::cerr << fmt::format("{}: stands still and is {}\n", shape.name(), what);
}

/// A file names no unit. Bodies that are taken for far larger than they are fall a short way of their size in the run,
/// and are heavier than what Bullet's solver in float32 moves.
void warn_if_all_fell(const Simulation& scene) {
    constexpr double large = 10; // metres
    const SceneDescription& description = scene.description();
    const std::vector<StepRow>& rows = scene.log().rows;
    const raycontact::Vec3 g = description.gravity;
    const double seconds = static_cast<double>(rows.size()) * description.dt;
    if (rows.back().median_speed < 0.9 * std::hypot(g.x, g.y, g.z) * seconds) return;
    double size = 0;
    for (const BodyStart& body : description.bodies) {
        if (!(body.density > 0)) continue;
        const raycontact::Shape& shape = *description.shapes[body.shape].shape;
        const raycontact::Vec3 low = shape.box_min(), high = shape.box_max();
        size = std::max({size, high.x - low.x, high.y - low.y, high.z - low.z});
    }
    if (size < large) return;
    std::cerr << fmt::format(
        "for {:.3g} s most bodies just fell: a mesh is {:.6g} m long, so it has far to fall, and is "
        "heavier than the solver can hold. Files are read in metres; where theirs is another "
        "unit, as millimetres, give --size: the longest edge in metres\n",
        seconds, size);
}

void run(const RunOptions& options) {
    check_common_options(options.settings);
    Outputs outputs(options);
    const auto start = std::chrono::steady_clock::now();
    Simulation scene(describe_scene(options.scene, options.settings));
    const SceneDescription& description = scene.description();
    std::set<std::uint32_t> moving, still;
    for (const BodyStart& body : description.bodies)
        if (body.density > 0)
            moving.insert(body.shape);
        else if (still.insert(body.shape).second)
            warn_if_open(description, body);
    for (const std::uint32_t shape : moving) warn_if_coarse(*description.shapes[shape].shape, options.settings);
    RunRecorder recorder(std::move(outputs.recording), scene);
    std::optional<raycontact::view::RunView> view;
    if (outputs.folder && !options.no_view) view.emplace();
    Progress progress(description.name, description.steps);
    listen_for_stop();
    for (std::uint32_t i = 0; i < description.steps && stop_signal() == 0; ++i) {
        scene.step();
        recorder.step();
        if (view) view->add(scene.scene());
        progress.show(i + 1);
    }
    progress.done();
    if (scene.steps() == 0) {
        std::cerr << "ended before the first step\n";
        return;
    }
    const bool cut_short = scene.steps() < description.steps;
    recorder.finish(cut_short);
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;

    print_warnings(scene.log().rows);
    if (!options.scene.meshes.empty()) warn_if_all_fell(scene);
    const Json result = summary(options, scene, wall.count());
    // File names are in it, which need not be text.
    const std::string text = result.dump(-1, ' ', false, Json::error_handler_t::replace);
    // What cannot be written is told last: the summary of a run of hours is worth more.
    std::string error = recorder.error();
    try {
        if (outputs.folder) {
            const raycontact::view::RunView* const gathered = view ? &*view : nullptr;
            write_files(*outputs.folder, log_of(scene, text), gathered, options.settings, cut_short);
        }
    } catch (const std::exception& unwritten) {
        error += (error.empty() ? "" : "; ") + std::string(unwritten.what());
    }
    std::cout << (options.json ? text + "\n" : for_a_person(result)) << std::flush;
    if (!error.empty()) throw std::runtime_error(error);
}

} // namespace

void add_run(CLI::App& app) {
    CLI::App* command = app.add_subcommand("run", "Simulate a scene: Bullet's response to RayContact's contacts");
    auto options = std::make_shared<RunOptions>();
    add_scene_options(*command, options->scene);
    add_out(*command, "--record", options->record,
            "write a recording there: for `raycontact replay`, and any glTF viewer")
        ->type_name("FILE.glb");
    add_out(*command, "--out", options->out,
            "write report.html, a 3D view of the run with plots and tables, and steps.csv there")
        ->type_name("DIR");
    command->add_flag("--no-view", options->no_view, "with --out: a report without the 3D view");
    command->add_flag("--json", options->json, "print one JSON object on stdout");
    options->settings.speculative = raycontact::Speculative::on;
    add_common_options(*command, options->settings);
    add_speculative_option(*command, options->settings);
    command->footer(stop_footer);
    command->callback([command, options] {
        if (command->count("--record") > 0) check_record(options->record);
        if (options->no_view && options->out.empty())
            throw InputError("--no-view: is for the report; give --out DIR, too");
        run(*options);
    });
}
