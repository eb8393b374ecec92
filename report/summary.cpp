// SPDX-License-Identifier: Apache-2.0
#include <report/page.h>

#include <raycontact/settings.h>
#include <report/counted.h>
#include <report/machine.h>
#include <report/svg.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace raycontact::report {
namespace {

using Json = nlohmann::ordered_json;

/// How a key of `run --json` reads for a person; `scale` turns its unit into the one shown.
struct Known {
    const char *key, *name, *unit, *meaning;
    double scale = 1;
};

constexpr Known known[] = {
    {"bodies", "Bodies", "", "moving; the ground not counted"},
    {"steps", "Steps", "", "of the simulation"},
    {"seed", "Seed", "", "of the bodies' first poses"},
    {"pairs_max", "Pairs, most in a step", "pairs", "bodies whose boxes overlap"},
    {"pairs_last_second", "Pairs, last second", "pairs", "median over the last second's steps"},
    {"rays", "Rays", "rays", "of the rule, less those the method had a reason to leave alone, in all steps together"},
    {"rays_cast", "Rays cast", "rays", "in full; of the others it is known how they end"},
    {"pairs_full", "Pairs in full", "", "directed pairs tested in full, each step counted"},
    {"pairs_skipped", "Pairs skipped", "", "directed pairs of which nothing was tested, each step counted"},
    {"pairs_as_standard", "Pairs as standard", "", "directed pairs left to standard, each step counted"},
    {"walks", "Walks", "rays", "followed from the last step's triangle, in all steps together"},
    {"walks_lost", "Walks lost", "rays", "of these, how many ended nowhere"},
    {"walk_casts", "Walks cast", "rays", "of those, how many were cast in full instead"},
    {"predictions", "Predictions", "rays", "vertices followed without contact, in all steps together"},
    {"pair_bytes_max", "Memory of pairs, most in a step", "MB", "what is kept for the open pairs", 1e-6},
    {"contacts", "Contacts", "contacts", "found in all steps together"},
    {"contacts_new", "Contacts that came", "contacts", "the step before did not have them"},
    {"contacts_lost", "Contacts that went", "contacts", "the step before had them"},
    {"ray_length", "Ray length", "m", "of all contacts of all steps, added up"},
    {"penetration_max", "Penetration, deepest", "mm", "deepest contact of the whole run", 1000},
    {"penetration_max_last_second", "Penetration, last second", "mm", "deepest contact of the last second", 1000},
    {"depth_limit", "Depth limit", "mm", "what counts as deep in the next three rows", 1000},
    {"deep_contacts", "Deep contacts", "", "contacts past the limit, each step counted"},
    {"deep_steps_longest", "Deep, longest", "steps", "for how many steps on end one contact stayed past the limit"},
    {"deep_steps_last_second", "Deep, last second", "steps", "the same, of those that reach into the last second"},
    {"median_speed_last_second", "Median speed, last second", "mm/s",
     "half of the bodies are slower; median over the last second's steps", 1000},
    {"below_ground", "Below ground", "bodies", "whose centre is lower than the ground at the end"},
    {"flown_off", "Flown off", "bodies",
     "beside the ground, in built-in scenes also higher than any started, at the end"},
    {"wall_ms", "Wall clock", "s", "all steps together, setup included, report not", 0.001},
    {"step_ms.median", "Step, median", "ms", "wall clock: detection and response"},
    {"step_ms.p95", "Step, 95th percentile", "ms", "one step in twenty takes longer"},
    {"narrow_ms.median", "Narrow phase, median", "ms", "wall clock of contact finding alone"},
    {"narrow_ms.p95", "Narrow phase, 95th percentile", "ms", "one step in twenty takes longer"},
    {"narrow_ms_last_second", "Narrow phase, last second", "ms", "its median there"},
    {"method", "Method", "", "how rays are kept from step to step"},
    {"caster", "Caster", "", "how a ray meets a mesh"},
    {"direction", "Direction", "", "what normal and depth are made of"},
    {"features", "Features", "", "of a mesh that can be in contact"},
    {"speculative", "Speculative contacts", "", "their margin in metres, or auto: before anything touches"},
    {"contacts_speculative", "Contacts before a touch", "", "in all steps together"},
    {"displacement_threshold", "Displacement threshold", "mm", "a pair may move so far before a full test", 1000},
    {"confidence", "Confidence", "", "how far ahead predictive rays look, in displacement thresholds"},
    {"culling_distance", "Culling distance", "mm", "how far ahead predictive rays look", 1000},
    {"distance_extension", "Distance extension", "mm", "by which predictive bounds are widened", 1000},
    {"max_iterations", "Triangles of a walk", "", "a ray may visit so many when it is followed"},
    {"cast_lost_walks", "Lost walks are cast", "", "in full, where following a ray ended nowhere"},
    {"max_contacts_per_pair", "Contacts a pair", "", "at most, those that stand for all; 0: all"},
    {"max_contacts", "Contacts a step", "", "at most, but the deepest of each pair; 0: all"},
    {"contacts_reduced", "Contacts left out", "", "by these limits, in all steps together"},
    {"devices", "Devices", "", "that cast the rays"},
    {"device_choice", "Device in use", "", "and why, at the end"},
    {"schedule", "Schedule", "", "which device a pair is on"},
    {"pairs_moved", "Pairs moved", "pairs", "from one device to another, in all steps together"},
    {"bytes_moved", "State moved", "bytes", "what was kept for them"},
    {"devices_lost", "Devices lost", "", "that failed; others cast their pairs in full"},
    {"hash", "Hash", "", "XXH64 over every contact of every step: the same on every device and thread count"},
};

/// The same of an entry of "work", of which the median step is shown.
constexpr Known device_known[] = {
    {"pairs", "Pairs", "pairs", "of this device, median step"},
    {"load", "Load", "pairs at rest", "what it had to do, counted, median step"},
    {"ms", "Time", "ms", "of its part of a step, with the host's share, median step"},
    {"launches", "Launches", "", "kernels started, median step"},
    {"reads", "Reads", "", "times the host waited for the device, median step"},
    {"bytes_up", "Copied to the device", "kB", "median step", 1e-3},
    {"bytes_down", "Copied from the device", "kB", "median step", 1e-3},
    {"busy_ms", "Device busy", "ms", "its kernels ran, median step"},
};

std::string as_text(const Json& value, double scale) {
    if (value.is_number_float() || (value.is_number() && scale != 1)) return readable(value.get<double>() * scale);
    if (value.is_number_unsigned() || value.is_number_integer()) return readable(value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    if (value.is_array()) {
        std::string text;
        for (const Json& item : value) text += (text.empty() ? "" : ", ") + as_text(item, scale);
        return text;
    }
    return value.dump();
}

/// {"step_ms": {"median": 1}} becomes "step_ms.median": 1.
void flatten(const Json& object, const std::string& before, std::vector<std::pair<std::string, Json>>& out) {
    for (const auto& [key, value] : object.items()) {
        if (value.is_object())
            flatten(value, before + key + ".", out);
        else
            out.emplace_back(before + key, value);
    }
}

std::string word(const Json& summary, const char* key, const char* otherwise) {
    const auto at = summary.find(key);
    return at == summary.end() ? otherwise : as_text(*at, 1);
}

/// The plain number of a key, as the command line takes it.
std::string option(const Json& summary, std::string key) {
    const auto at = summary.find(key);
    if (at == summary.end() || at->is_object()) return "";
    std::string text;
    if (at->is_array())
        for (const Json& item : *at)
            text +=
                fmt::format("{}{}", text.empty() ? "" : ",", item.is_string() ? item.get<std::string>() : item.dump());
    else
        text = at->is_string() ? at->get<std::string>() : at->dump();
    std::replace(key.begin(), key.end(), '_', '-');
    return text.empty() ? "" : fmt::format(" --{} {}", key, text);
}

/// The thresholds that are not what they are anyway.
std::string thresholds(const Json& summary) {
    const PaperOptions usual;
    const std::pair<const char*, Json> all[] = {{"displacement_threshold", nullptr},
                                                {"confidence", usual.confidence},
                                                {"culling_distance", nullptr},
                                                {"distance_extension", nullptr},
                                                {"max_iterations", usual.max_iterations},
                                                {"cast_lost_walks", usual.cast_lost_walks},
                                                {"speculative", "auto"},
                                                {"max_contacts_per_pair", 0},
                                                {"max_contacts", 0}};
    std::string text;
    for (const auto& [key, otherwise] : all)
        if (const auto at = summary.find(key); at != summary.end() && *at != otherwise)
            text += key == std::string("cast_lost_walks") ? " --no-walk-casts" : option(summary, key);
    return text;
}

} // namespace

void describe(const scenes::RunLog& log, Page& page) {
    Json summary = Json::parse(log.summary_json, nullptr, false);
    if (!summary.is_object()) summary = Json::object();

    std::size_t moving = 0;
    for (const bool moves : log.body_moves) moving += moves;
    const double seconds = static_cast<double>(log.rows.size()) * log.dt;
    const Machine machine = this_machine();
    page.title = fmt::format("{}: {}", log.scene.empty() ? "run" : log.scene, counted(moving, "mesh", "meshes"));
    page.title[0] =
        static_cast<char>(page.title[0] >= 'a' && page.title[0] <= 'z' ? page.title[0] - 'a' + 'A' : page.title[0]);
    page.summary = fmt::format(
        "{} over {}, {:.3g} s of simulated time at {:.4g} steps a second. Meshes: {}. All contacts between meshes were "
        "found by RayContact by casting rays from the vertices of one mesh into the other (method {}, caster {}, "
        "direction {}, features {}); the response is Bullet's sequential impulse solver. Times are wall clock on {} "
        "core{} ({}), devices: {}.",
        counted(moving, "body", "bodies"), counted(log.rows.size(), "step", "steps"), seconds, 1 / log.dt,
        log.mesh_source.empty() ? "of unknown origin" : log.mesh_source, word(summary, "method", "standard"),
        word(summary, "caster", "bvh"), word(summary, "direction", "reprojected"), word(summary, "features", "edges"),
        machine.cores, machine.cores == 1 ? "" : "s", machine.cpu, word(summary, "devices", "cpu"));

    std::vector<std::pair<std::string, Json>> figures;
    flatten(summary, "", figures);
    const auto take = [&figures](const std::string& key) {
        for (auto it = figures.begin(); it != figures.end(); ++it)
            if (it->first == key) {
                Json value = it->second;
                figures.erase(it);
                return value;
            }
        return Json();
    };
    take("scene");
    take("mesh_source"); // in the summary already
    if (const Json planned = take("steps_planned"), cut = take("cut_short"); cut == true) {
        page.title += " (cut short)";
        page.summary =
            fmt::format("Cut short: {} of {} steps were done. ", log.rows.size(), as_text(planned, 1)) + page.summary;
    }
    for (const Known& k : known)
        if (const Json value = take(k.key); !value.is_null()) {
            // A seed is a name, not an amount.
            const std::string text = std::string_view(k.key) == "seed" ? value.dump() : as_text(value, k.scale);
            page.rows.push_back({k.name, text, k.unit, k.meaning});
        }
    for (const Json& device : take("work")) // of each device
        for (const Known& k : device_known)
            if (const auto at = device.find(k.key); at != device.end())
                page.rows.push_back({fmt::format("{}, {}", k.name, word(device, "device", "device")),
                                     as_text((*at)["median"], k.scale), k.unit, k.meaning});
    for (const auto& [key, value] : figures)
        page.rows.push_back({key, as_text(value, 1), "", "as `run --json` prints it"});

    // A row of zeros says little, a sentence of them that nothing of the kind happened.
    const auto nothing = [](const Row& row) { return row.value == "0" && row.name != "Seed"; };
    for (const Row& row : page.rows)
        if (nothing(row)) page.zeros += (page.zeros.empty() ? "None, or 0: " : ", ") + row.name;
    if (!page.zeros.empty()) page.zeros += ".";
    std::erase_if(page.rows, nothing);

    page.command = "raycontact run " + (log.arguments.empty() ? "SCENE" : log.arguments) + option(summary, "steps")
                   + " --seed " + std::to_string(log.seed);
    for (const char* key : {"method", "caster", "direction", "features"}) page.command += option(summary, key);
    page.command += thresholds(summary) + option(summary, "devices") + " --out DIR";
    page.footer = "The same command gives the same contacts and hash; times differ from machine to machine.";
}

} // namespace raycontact::report
