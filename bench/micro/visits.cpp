// SPDX-License-Identifier: Apache-2.0
#include "bench/micro/visits.h"

#include "shape/shape_data.h"

// The kernels once more, with counters put between their lines by macros of the names that they call. The words of the
// dialect are those of the enclosing namespace.
namespace raycontact::kernels::prototype::counted {

namespace {
struct Counts {
    std::uint64_t children = 0, triangle_blocks = 0, products = 0;
} seen;
} // namespace

DEVICE float product_error(float a, float b, float p) {
    ++seen.products;
    return __builtin_fmaf(a, b, -p);
}

#include "kernels/triangle.h"
#define hit_block(...) (++seen.triangle_blocks, hit_block(__VA_ARGS__))
#define lowest_bit(bits) (++seen.children, lowest_bit(bits))
#include "kernels/traverse.h"

#include "kernels/source_ray.h"

#include "kernels/ray_group.h"

#include "kernels/near_leaves.h"

#include "kernels/traverse_group.h"

#include "kernels/vertex_lanes.h"

#include "kernels/clearance.h"

#include "kernels/find_clusters.h"

#include "kernels/find_vertices.h"
#undef lowest_bit
#undef hit_block
#include "kernels/cast_rays.h"

} // namespace raycontact::kernels::prototype::counted

namespace raycontact::bench {

namespace counted = kernels::prototype::counted;

Visits count_visits(const Batch& batch, const std::vector<kernels::Ray>& rays) {
    const ShapeData& shape = batch.shape->data();
    const auto pairs = static_cast<kernels::uint>(batch.ordered.size());
    Visits visits;

    std::vector<kernels::uint> found(pairs);
    std::vector<kernels::ulong> small(pairs);
    counted::seen = {};
    counted::count_clusters({0, pairs}, pairs, batch.ordered.data(), &shape.header, shape.clusters.data(), found.data(),
                            small.data());
    if (shape.header.vertex_block_count <= SMALL_BLOCKS) {
        visits.cluster_blocks = shape.header.cluster_count[0];
    } else { // every child that is entered is a test, but for the vertex blocks found
        std::uint64_t blocks = 0;
        for (const kernels::uint n : found) blocks += n;
        visits.cluster_blocks = shape.header.cluster_count[shape.header.cluster_levels - 1]
                                + static_cast<double>(counted::seen.children - blocks) / pairs;
    }

    const auto count = static_cast<kernels::uint>(rays.size());
    std::vector<kernels::Hit> hits(count);
    counted::seen = {};
    counted::cast_rays_bvh({0, count}, count, 0u, batch.ordered.data(), &shape.header, shape.vertex_blocks.data(),
                           shape.nodes.data(), shape.triangle_blocks.data(), shape.face_normals.data(), rays.data(),
                           hits.data());
    std::uint64_t traversals = 0; // the rare side tests included
    for (const kernels::Hit& hit : hits) traversals += 1 + hit.sides;
    const counted::Counts& seen = counted::seen;
    const auto per_ray = [&](std::uint64_t n) { return static_cast<double>(n) / count; };
    visits.nodes = per_ray(traversals + seen.children - seen.triangle_blocks); // the root is nobody's child
    visits.triangle_blocks = per_ray(seen.triangle_blocks);
    visits.close_looks = per_ray(seen.products / 6); // two for each of three edges
    return visits;
}

} // namespace raycontact::bench
