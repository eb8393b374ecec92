// SPDX-License-Identifier: Apache-2.0
#include "mesh/vector.h"
#include "shape/build.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

// Of narrower triangles the normal is not accurate to 1e-8.
constexpr double least_sine = 1e-8;

void fill(const ShapeData& shape, const kernels::TriangleBlock& block, BlockBounds& bounds) {
    for (std::size_t k = 0; k < TRIANGLE_LANES; ++k) {
        const std::uint32_t t = block.triangle[k];
        constexpr float nan = std::numeric_limits<float>::quiet_NaN();
        const auto corner = [&](std::size_t c) { return t == NONE ? Vec3{nan, nan, nan} : shape.corner(t, c); };
        const Vec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a, normal = cross(ab, ac);
        const double size = length(normal);
        const double scale = size > least_sine * length(ab) * length(ac) ? 1 / size : 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const float p = block.corner[i][k], q = block.corner[3 + i][k], r = block.corner[6 + i][k];
            bounds.box[i][k] = std::min({p, q, r});
            bounds.box[3 + i][k] = std::max({p, q, r});
            bounds.plane[i][k] = static_cast<float>(scale * axis(normal, i));
        }
        bounds.plane[3][k] = static_cast<float>(scale * dot(normal, a));
        bounds.span[k] = 0;
        for (std::size_t c = 0; c < 3; ++c)
            if (t != NONE && (shape.sharp_edges[t] >> c & 1u) != 0)
                bounds.span[k] = std::max(bounds.span[k], shape.edge_span(t, c));
    }
}

} // namespace

void find_block_bounds(ShapeData& shape, Executor& executor) {
    shape.block_bounds.resize(shape.triangle_blocks.size());
    executor.run(static_cast<std::uint32_t>(shape.triangle_blocks.size()), 64,
                 [&](std::uint32_t begin, std::uint32_t end) {
                     for (std::uint32_t i = begin; i < end; ++i)
                         fill(shape, shape.triangle_blocks[i], shape.block_bounds[i]);
                 });
}

} // namespace raycontact
