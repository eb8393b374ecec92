// SPDX-License-Identifier: Apache-2.0
#include "cli/run_scene.h"

#include "cli/cavities_option.h"
#include "cli/number_option.h"
#include "cli/scene_file.h"
#include "cli/weld_option.h"

#include <raycontact/error.h>
#include <scenes/avalanche.h>
#include <scenes/own.h>
#include <scenes/rain.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>

namespace {

using raycontact::InputError;
using raycontact::Settings;
using namespace raycontact::scenes;

bool is_scene_file(const std::string& name) {
    std::string ending = std::filesystem::path(name).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending == ".json";
}

/// As a shell takes it.
std::string shell_word(const std::string& word) {
    const auto plain = [](unsigned char c) {
        return std::isalnum(c) != 0 || std::string("/._-+=:,@%").find(c) != std::string::npos;
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

void refuse_mesh_options(const RunScene& given) {
    const std::string only = ": is for a run of your own meshes (--mesh)";
    if (given.size) throw InputError("--size" + only);
    if (given.density) throw InputError("--density" + only);
    if (given.ground) throw InputError("--ground" + only);
    if (given.nested) throw InputError("--cavities" + only);
    if (given.weld) throw InputError("--weld" + only);
}

void take_common(SceneOptions& how, const RunScene& given, const Settings& settings) {
    how.bodies = given.bodies.value_or(how.bodies);
    how.steps = given.steps.value_or(how.steps);
    how.seed = given.seed.value_or(how.seed);
    how.settings = settings;
}

/// One of the paper's; `how`: what it has by itself.
SceneDescription named(SceneDescription (*make)(const SceneOptions&), SceneOptions how, const RunScene& given,
                       const Settings& settings) {
    refuse_mesh_options(given);
    take_common(how, given, settings);
    return make(how);
}

SceneDescription from_file(const RunScene& given, const Settings& settings) {
    refuse_mesh_options(given);
    if (given.bodies) throw InputError("--bodies: " + given.scene + " lists its bodies itself");
    SceneDescription scene = read_scene_file(given.scene, {given.steps, given.seed, settings});
    scene.arguments = shell_word(given.scene);
    return scene;
}

void check_positive(const std::optional<double>& value, const char* option, const char* unit) {
    if (value && !(std::isfinite(*value) && *value > 0))
        throw InputError(fmt::format("{}: {} is not a positive number of {}", option, *value, unit));
}

SceneDescription from_meshes(const RunScene& given, const Settings& settings) {
    check_positive(given.size, "--size", "metres");
    check_positive(given.density, "--density", "kilograms a cubic metre");
    OwnOptions how;
    take_common(how, given, settings);
    how.files.assign(given.meshes.begin(), given.meshes.end());
    how.size = given.size;
    how.density = given.density.value_or(how.density);
    how.nesting = given.nested.value_or(how.nesting);
    how.weld = given.weld;
    how.plane = given.ground == "plane";
    if (given.ground && !how.plane) how.ground = *given.ground;
    SceneDescription scene = own(how);
    scene.arguments = "--mesh";
    for (const std::string& file : given.meshes) scene.arguments += " " + shell_word(file);
    scene.arguments += fmt::format(" --bodies {}", how.bodies);
    if (given.size) scene.arguments += fmt::format(" --size {}", *given.size);
    if (given.ground) scene.arguments += " --ground " + shell_word(*given.ground);
    if (given.density) scene.arguments += fmt::format(" --density {}", *given.density);
    if (given.nested) scene.arguments += fmt::format(" --cavities {}", cavities_word(*given.nested));
    if (given.weld) scene.arguments += fmt::format(" --weld {}", *given.weld);
    return scene;
}

} // namespace

void add_scene_options(CLI::App& command, RunScene& scene) {
    command.add_option("SCENE", scene.scene,
                       "avalanche: concave meshes in a cubic grid fall on a slab; rain: a source on a circle lets go "
                       "ten bodies a second, of four shapes; FILE.json: a scene of your own (docs/scene-files.md)");
    command
        .add_option("--mesh", scene.meshes,
                    "in place of SCENE: these meshes, in turn, fall from a cubic grid; z is up, units are metres")
        ->type_name("FILE")
        ->expected(1, 1000);
    add_number(command, "--size", scene.size, "with --mesh: longest edge of each mesh's box; else as in the file", 0.0,
               std::numeric_limits<double>::max());
    command
        .add_option("--ground", scene.ground,
                    "with --mesh: a mesh that stands still where its file places it, or plane: an endless one, z = 0, "
                    "whose contacts are not counted; else a slab")
        ->type_name("FILE|plane");
    add_cavities_option(command, scene.nested);
    add_weld_option(command, scene.weld);
    add_number(command, "--density", scene.density, "with --mesh: kilograms a cubic metre", 0.0,
               std::numeric_limits<double>::max())
        ->type_name("D")
        ->default_str("1000");
    add_number(command, "--steps", scene.steps, "steps of 1/60 s, or of the scene file's dt", 1u, 10'000'000u)
        ->default_str("avalanche and --mesh 600, rain 3000");
    add_number(command, "--bodies", scene.bodies, "moving bodies", 1u, 1'000'000u)
        ->default_str("avalanche 512, rain 500, --mesh 64");
    add_number(command, "--seed", scene.seed, "of the bodies' small offsets and tilts; same seed, same hash",
               std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max())
        ->type_name("S")
        ->default_str("1");
}

SceneDescription describe_scene(const RunScene& given, const Settings& settings) {
    if (!given.meshes.empty()) {
        if (!given.scene.empty())
            throw InputError("--mesh: the scene \"" + given.scene + "\" has its own meshes; give one of the two");
        return from_meshes(given, settings);
    }
    if (given.scene.empty()) throw InputError("SCENE: give avalanche, rain or FILE.json, or your own meshes by --mesh");
    if (given.scene == "avalanche") return named(avalanche, SceneOptions(), given, settings);
    if (given.scene == "rain") return named(rain, RainOptions(), given, settings);
    if (is_scene_file(given.scene)) return from_file(given, settings);
    throw InputError("SCENE: \"" + given.scene + "\" is not known; scenes are: avalanche, rain, FILE.json");
}
