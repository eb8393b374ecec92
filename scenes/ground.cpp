// SPDX-License-Identifier: Apache-2.0
#include <scenes/ground.h>

namespace raycontact::scenes {

namespace {

Mesh slab(double half_width, double depth) {
    Mesh mesh;
    mesh.name = "ground slab";
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(
            {i & 1 ? half_width : -half_width, i & 2 ? half_width : -half_width, i & 4 ? 0 : -depth});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

} // namespace

void add_slab(SceneDescription& description, double half_width, double top, double depth) {
    BodyStart body;
    body.shape = static_cast<std::uint32_t>(description.shapes.size());
    body.density = 0;
    description.shapes.push_back({Shape::make(slab(half_width, depth)), bullet::Bounds::vertices, {}});
    description.slab = static_cast<std::uint32_t>(description.bodies.size());
    description.bodies.push_back(body);
    description.region = {{-half_width, -half_width, 0}, {half_width, half_width, top}};
}

} // namespace raycontact::scenes
