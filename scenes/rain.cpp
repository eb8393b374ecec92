// SPDX-License-Identifier: Apache-2.0
#include <scenes/rain.h>

#include <scenes/circle_source.h>
#include <scenes/ground.h>
#include <scenes/models/model.h>

#include <string>
#include <utility>

namespace raycontact::scenes {

SceneDescription rain(const SceneOptions& options) {
    constexpr double height = 7; // metres
    SceneDescription scene = begin_scene("rain", options);
    add_slab(scene, 15, height + 1);

    CircleSource source;
    const std::pair<std::string, std::uint32_t> models[] = {
        {options.model, options.triangles}, {"torus", 2130}, {"star", 3456}, {"knot", 3458}};
    for (const auto& [kind, triangles] : models) {
        const Model model = scene_model(kind, triangles);
        source.shapes.push_back(static_cast<std::uint32_t>(scene.shapes.size()));
        scene.shapes.push_back({Shape::make(stood_up(model.mesh)), bullet::Bounds::box, model.source});
    }
    source.bodies = options.bodies;
    source.centre = {0, 0, height};
    source.radius = 2.5;
    source.period = 1.3;
    Random random(options.seed);
    add_source(scene, source, random);
    return scene;
}

} // namespace raycontact::scenes
