// SPDX-License-Identifier: Apache-2.0
#include "mesh/components.h"

#include "executor/executor.h"
#include "executor/float_environment.h"
#include "mesh/disjoint_sets.h"
#include "mesh/nesting.h"
#include "mesh/predicates.h"
#include "mesh/split.h"
#include "mesh/surface.h"

namespace raycontact {

std::optional<Components> find_components(const Mesh& mesh, std::uint32_t threads) {
    const FloatEnvironment environment; // the predicates need rounding to nearest
    // Holes as they are: a sheet would be spanned by a copy of itself, and each triangle closed by its own.
    const PreparedMesh prepared = prepare_mesh(
        mesh, {.holes = Holes::none, .overlaps = Overlaps::leave, .check = Check::topology, .threads = threads});
    const std::vector<Triangle>& triangles = prepared.triangles;
    const Patches patches = find_patches(triangles, sorted_half_edges(triangles));
    DisjointSets sets;
    sets.reset(patches.list.size());
    std::vector<std::uint32_t> open_at(prepared.vertices.size(), in_none); // one of the open patches at each vertex
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const std::uint32_t patch = patches.of[t];
        if (patches.list[patch].closed) continue;
        for (const std::uint32_t v : triangles[t]) {
            if (open_at[v] == in_none) open_at[v] = patch;
            sets.join(open_at[v], patch);
        }
    }
    const std::vector<Vec3> exact = snapped(prepared.vertices);
    Executor executor(threads_for(triangles.size(), threads));
    const Surface surface(triangles, exact, executor);
    const auto solids = solids_around(prepared, patches, [&]() -> const MeshTree& { return surface.tree(); });
    if (!solids) return std::nullopt;
    for (std::uint32_t p = 0; p < solids->size(); ++p) sets.join(p, (*solids)[p]);

    Components components{0, std::vector<std::uint32_t>(mesh.triangles.size(), in_none)};
    std::vector<std::uint32_t> number(patches.list.size(), in_none);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const std::uint32_t set = sets.of(patches.of[t]);
        if (number[set] == in_none) number[set] = components.count++;
        components.of[prepared.triangle_index[t]] = number[set];
    }
    return components;
}

} // namespace raycontact
