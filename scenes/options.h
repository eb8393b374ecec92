// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>

#include <cstdint>
#include <string>

namespace raycontact::scenes {

/// What can be asked of each built-in scene.
struct SceneOptions {
    std::uint32_t bodies = 512;    ///< that move, 1 to 2^20
    std::uint32_t steps = 600;     ///< planned, of 1/60 s
    std::uint64_t seed = 1;        ///< of how the bodies begin
    std::string model = "bunny";   ///< see scene_model
    std::uint32_t triangles = 902; ///< of that model
    Settings settings;             ///< of RayContact
    Response response;
};

/// What the options say of a scene, before it has bodies.
inline SceneDescription begin_scene(const std::string& name, const SceneOptions& options) {
    SceneDescription scene;
    scene.name = name;
    scene.arguments = name + " --bodies " + std::to_string(options.bodies);
    scene.seed = options.seed;
    scene.steps = options.steps;
    scene.settings = options.settings;
    scene.response = options.response;
    return scene;
}

} // namespace raycontact::scenes
