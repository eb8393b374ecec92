// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>
#include <scenes/description.h>

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Which scene `run` is to simulate; what is not given is left to the scene.
struct RunScene {
    std::string scene;               ///< "avalanche", "rain", FILE.json; empty where meshes are given
    std::vector<std::string> meshes; ///< files, in turn
    std::optional<std::uint32_t> steps, bodies;
    std::optional<std::uint64_t> seed;
    std::optional<double> size, density; ///< metres, kg/m^3
    std::optional<std::string> ground;   ///< FILE or "plane"
    std::optional<raycontact::Nesting> nested;
    std::optional<double> weld; ///< metres
};

/// Adds SCENE, --mesh, --steps, --bodies, --seed, --size, --ground, --density, --cavities and --weld; `scene` is filled
/// while the command line is read and must outlive it.
void add_scene_options(CLI::App& command, RunScene& scene);

/// Throws InputError naming the option, or the file and the field.
raycontact::scenes::SceneDescription describe_scene(const RunScene& scene, const raycontact::Settings& settings);
