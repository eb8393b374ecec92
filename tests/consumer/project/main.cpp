// SPDX-License-Identifier: Apache-2.0
// The first program of a user: two cubes, one corner of each inside the other.
#include <raycontact/scene.h>

#include <cstdio>
#include <span>
#include <vector>

int main() {
    raycontact::Mesh cube;
    cube.name = "cube";
    cube.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    cube.triangles = {{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                      {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    const auto shape = raycontact::Shape::make(cube);

    raycontact::Scene scene;
    scene.add(shape);
    scene.add(shape, {.translation = {0.8, 0.7, 0.6}});
    for (const auto& contact : scene.find_contacts()) {
        std::printf("%016llx: depth %.3f, normal %.1f %.1f %.1f\n", static_cast<unsigned long long>(contact.key()),
                    static_cast<double>(contact.depth), static_cast<double>(contact.normal.x),
                    static_cast<double>(contact.normal.y), static_cast<double>(contact.normal.z));
    }
    // The same into arrays of one's own; of a GPU by UserMemory::cuda() or opencl().
    std::vector<float> depths(100);
    const raycontact::ContactOutput column{raycontact::ContactColumn::depth,
                                           raycontact::UserMemory::host(std::as_writable_bytes(std::span(depths)))};
    const bool written = scene.write_contacts({&column, 1}) == 6 && depths[5] == scene.contacts()[5].depth;
    return written ? 0 : 1; // a corner in each cube, and beside them edges that pass
}
