// SPDX-License-Identifier: Apache-2.0
#include <scenes/own.h>

#include <scenes/centred_shape.h>
#include <scenes/grid.h>
#include <scenes/ground.h>
#include <scenes/meshes_in_words.h>

#include <algorithm>
#include <utility>

namespace raycontact::scenes {

SceneDescription own(const OwnOptions& options) {
    SceneDescription scene = begin_scene("own", options);
    const auto load = [&](const std::filesystem::path& file) {
        Mesh mesh = load_mesh(file);
        return options.weld ? weld_mesh(std::move(mesh), *options.weld) : mesh;
    };
    double diameter = 0, largest = 0, smallest = Region::inf;
    for (const std::filesystem::path& file : options.files) {
        const CentredShape mesh = centred_shape(load(file), options.size, 1, options.nesting);
        diameter = std::max(diameter, 2 * mesh.shape->radius());
        largest = std::max(largest, mesh.extent);
        smallest = std::min(smallest, mesh.extent);
        scene.shapes.push_back({mesh.shape, bullet::Bounds::box, mesh_in_words(file.filename().string(), *mesh.shape)});
    }
    scene.response.size = smallest;
    scene.depth_limit *= smallest;

    // 0.05 apart, of which the offsets of two neighbours take 0.04 at most.
    Grid grid{options.bodies, 1.05 * diameter, 0.02 * diameter, 0.55 * diameter};
    std::shared_ptr<const Shape> ground;
    Vec3 middle; // of the grid
    if (options.ground) {
        ground = Shape::make(prepare_mesh(load(*options.ground), {.nesting = options.nesting}));
        const Vec3 low = ground->box_min(), high = ground->box_max();
        middle = {(low.x + high.x) / 2, (low.y + high.y) / 2, 0};
        grid.bottom += high.z;
    }
    Random random(options.seed);
    for (const btTransform& pose : grid.poses(random)) {
        BodyStart body;
        body.shape = static_cast<std::uint32_t>(scene.bodies.size() % options.files.size());
        body.pose = pose;
        body.pose.getOrigin() += btVector3(btScalar(middle.x), btScalar(middle.y), 0);
        body.density = options.density;
        scene.bodies.push_back(body);
    }

    const double top = grid.top() + diameter;
    if (ground) {
        BodyStart body;
        body.shape = static_cast<std::uint32_t>(scene.shapes.size());
        body.density = 0;
        scene.shapes.push_back(
            {ground, bullet::Bounds::vertices, mesh_in_words(options.ground->filename().string(), *ground)});
        scene.bodies.push_back(body);
        scene.region = {ground->box_min(), {ground->box_max().x, ground->box_max().y, top}};
    } else if (options.plane) {
        scene.plane = true;
        scene.region.low.z = 0;
        scene.region.high.z = top;
    } else {
        add_slab(scene, std::max(10 * largest, 2.5 * grid.spacing * grid.side()), top, std::max(2.0, 2 * largest));
    }
    return scene;
}

} // namespace raycontact::scenes
