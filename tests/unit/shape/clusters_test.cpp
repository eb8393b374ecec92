// SPDX-License-Identifier: Apache-2.0
#include "scenes/models/model.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

bool inside(const kernels::ClusterBlock& block, int lane, const Point3f& p) {
    const float at[3] = {p.x, p.y, p.z};
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(at[axis] - block.centre[axis][lane]) > block.half_size[axis][lane]) return false;
    return true;
}

TEST(Clusters, EveryRayVertexOnceAndInEveryBoxAboveIt) {
    for (const std::uint32_t triangles : {64u, 902u, 40000u}) {
        const auto shape = Shape::make(scenes::scene_model("torus", triangles).mesh);
        const ShapeData& data = shape->data();
        std::vector<int> seen(data.points.size(), 0);
        for (std::size_t b = 0; b < data.header.vertices.block_count; ++b) {
            for (const auto v : data.vertex_blocks[b].vertex) {
                if (v == NONE) continue;
                ++seen[v];
                std::size_t child = b;
                for (std::uint32_t level = 0; level < data.header.vertices.cluster_levels; ++level) {
                    const std::size_t block = child / VERTEX_LANES;
                    ASSERT_LT(block, data.header.vertices.cluster_count[level]);
                    ASSERT_TRUE(inside(data.clusters[data.header.vertices.cluster_first[level] + block],
                                       static_cast<int>(child % VERTEX_LANES), data.points[v]));
                    child = block;
                }
            }
        }
        for (std::size_t v = 0; v < seen.size(); ++v) ASSERT_EQ(seen[v], data.exit_distances[v] > 0) << v;
        EXPECT_LE(data.header.vertices.block_count, data.points.size() / VERTEX_LANES + 1) << "blocks are full";
    }
}

} // namespace
} // namespace raycontact
