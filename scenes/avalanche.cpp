// SPDX-License-Identifier: Apache-2.0
#include <scenes/avalanche.h>

#include <scenes/grid.h>
#include <scenes/ground.h>
#include <scenes/models/model.h>

#include <algorithm>

namespace raycontact::scenes {

SceneDescription avalanche(const SceneOptions& options) {
    const Model model = scene_model(options.model, options.triangles);
    SceneDescription scene = begin_scene("avalanche", options);
    scene.shapes.push_back({Shape::make(stood_up(model.mesh)), bullet::Bounds::box, model.source});

    const Grid grid{options.bodies, 1.05, 0.02, 0.75};
    Random random(options.seed);
    for (const btTransform& pose : grid.poses(random)) scene.bodies.emplace_back().pose = pose;
    add_slab(scene, std::max(10.0, 2.5 * grid.spacing * grid.side()), grid.top() + 1);
    return scene;
}

} // namespace raycontact::scenes
