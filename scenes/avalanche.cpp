// SPDX-License-Identifier: Apache-2.0
#include <scenes/avalanche.h>

#include <raycontact/error.h>
#include <scenes/grid.h>
#include <scenes/ground.h>
#include <scenes/models/model.h>
#include <scenes/random.h>

#include <algorithm>

namespace raycontact::scenes {

namespace {

constexpr std::uint32_t most_bodies = 1u << 20;

void check(const AvalancheOptions& o) {
    if (o.bodies < 1 || o.bodies > most_bodies)
        throw InputError("avalanche: " + std::to_string(o.bodies) + " bodies; choose 1 to "
                         + std::to_string(most_bodies));
    if (!(o.density > 0) || !(o.spacing > 0)) throw InputError("avalanche: density and spacing must be positive");
}

} // namespace

SceneDescription avalanche(const AvalancheOptions& options) {
    check(options);
    const Model model = scene_model(options.model, options.triangles);
    SceneDescription scene;
    scene.name = "avalanche";
    scene.arguments = "avalanche --bodies " + std::to_string(options.bodies);
    scene.seed = options.seed;
    scene.steps = options.steps;
    scene.settings = options.settings;
    scene.response = options.response;
    scene.shapes.push_back({Shape::make(stood_up(model.mesh)), bullet::Bounds::box, model.source});

    const Grid grid{options.bodies, options.spacing, 0.02, 0.75};
    Random random(options.seed);
    for (const btTransform& pose : grid.poses(random)) {
        BodyStart& body = scene.bodies.emplace_back();
        body.pose = pose;
        body.density = options.density;
    }
    add_slab(scene, std::max(10.0, 2.5 * options.spacing * grid.side()), grid.top() + 1);
    return scene;
}

} // namespace raycontact::scenes
