// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>

#include <cstdint>
#include <filesystem>
#include <optional>

/// What the command line says otherwise than the file.
struct SceneFileOptions {
    std::optional<std::uint32_t> steps;
    std::optional<std::uint64_t> seed;
    raycontact::Settings settings;
};

/// Reads a scene for `raycontact run FILE.json`; docs/scene-files.md lists its fields. Paths are relative to the file.
/// Throws InputError naming the file and the field for whatever is not exactly that.
raycontact::scenes::SceneDescription read_scene_file(const std::filesystem::path& file,
                                                     const SceneFileOptions& options);
