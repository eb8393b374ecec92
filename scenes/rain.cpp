// SPDX-License-Identifier: Apache-2.0
#include <scenes/rain.h>

#include <raycontact/error.h>
#include <scenes/circle_source.h>
#include <scenes/ground.h>
#include <scenes/models/model.h>
#include <scenes/random.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

namespace {

constexpr std::uint32_t most_bodies = 1u << 20;

void check(const RainOptions& o) {
    if (o.bodies < 1 || o.bodies > most_bodies)
        throw InputError("rain: " + std::to_string(o.bodies) + " bodies; choose 1 to " + std::to_string(most_bodies));
    const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
    if (!positive(o.rate) || !positive(o.radius) || !positive(o.height) || !positive(o.period) || !positive(o.density))
        throw InputError("rain: rate, radius, height, period and density must be positive");
}

} // namespace

SceneDescription rain(const RainOptions& options) {
    check(options);
    SceneDescription scene;
    scene.name = "rain";
    scene.arguments = "rain --bodies " + std::to_string(options.bodies);
    scene.seed = options.seed;
    scene.steps = options.steps;
    scene.settings = options.settings;
    scene.response = options.response;
    add_slab(scene, std::max(15.0, 4 * options.radius), options.height + 1);

    CircleSource source;
    const std::pair<std::string, std::uint32_t> models[] = {
        {options.model, 902}, {"torus", 2130}, {"star", 3456}, {"knot", 3458}};
    for (const auto& [kind, triangles] : models) {
        const Model model = scene_model(kind, triangles);
        source.shapes.push_back(static_cast<std::uint32_t>(scene.shapes.size()));
        scene.shapes.push_back({Shape::make(stood_up(model.mesh)), bullet::Bounds::box, model.source});
    }
    source.bodies = options.bodies;
    source.rate = options.rate;
    source.centre = {0, 0, options.height};
    source.radius = options.radius;
    source.period = options.period;
    source.density = options.density;
    Random random(options.seed);
    add_source(scene, source, random);
    return scene;
}

} // namespace raycontact::scenes
