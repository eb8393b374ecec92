// SPDX-License-Identifier: Apache-2.0
#include "mesh/split.h"

#include "mesh/adjacency.h"

#include <algorithm>

namespace raycontact {

std::vector<Mesh> split_mesh(const Mesh& mesh, std::span<const std::uint32_t> set_of, std::size_t count) {
    std::vector<Mesh> meshes(count);
    // The triangles of each set together, so that each vertex needs one number at a time.
    std::vector<std::uint32_t> order, number(mesh.vertices.size(), in_none), owner(number);
    for (std::uint32_t t = 0; t < set_of.size(); ++t)
        if (set_of[t] != in_none) order.push_back(t);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t t) { return set_of[t]; });
    for (const std::uint32_t t : order) {
        Mesh& own = meshes[set_of[t]];
        Triangle corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.triangles[t][k];
            if (owner[v] != set_of[t]) {
                owner[v] = set_of[t];
                number[v] = static_cast<std::uint32_t>(own.vertices.size());
                own.vertices.push_back(mesh.vertices[v]);
            }
            corners[k] = number[v];
        }
        own.triangles.push_back(corners);
    }
    return meshes;
}

} // namespace raycontact
