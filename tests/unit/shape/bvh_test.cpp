// SPDX-License-Identifier: Apache-2.0
#include "scenes/models/model.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <vector>

namespace raycontact {
namespace {

// Every triangle below a child lies in its box; every triangle is reached once; no path is deeper than the trail.
void walk(const ShapeData& shape, std::uint32_t at, int level, std::vector<int>& reached) {
    ASSERT_LE(level, NODE_LEVELS);
    const kernels::Node& node = shape.nodes[at];
    for (int lane = 0; lane < NODE_LANES; ++lane) {
        if (node.child[lane] == NONE) {
            EXPECT_GT(node.bounds[0][lane], node.bounds[3][lane]);
            continue;
        }
        std::vector<int> below(shape.mesh.triangles.size(), 0);
        if (node.child[lane] & LEAF) {
            for (const auto t : shape.triangle_blocks[node.child[lane] & ~LEAF].triangle)
                if (t != NONE) ++below[t];
        } else {
            EXPECT_EQ(shape.nodes[node.child[lane]].parent, at);
            walk(shape, node.child[lane], level + 1, below);
        }
        for (std::size_t t = 0; t < below.size(); ++t) {
            if (below[t] == 0) continue;
            reached[t] += below[t];
            for (const auto v : shape.mesh.triangles[t]) {
                const Point3f p = shape.points[v];
                ASSERT_TRUE(node.bounds[0][lane] < p.x && p.x < node.bounds[3][lane]);
                ASSERT_TRUE(node.bounds[1][lane] < p.y && p.y < node.bounds[4][lane]);
                ASSERT_TRUE(node.bounds[2][lane] < p.z && p.z < node.bounds[5][lane]);
            }
        }
    }
}

TEST(Bvh, HoldsEveryTriangleOnce) {
    for (const char* kind : {"knot", "gear", "torus", "sphere"})
        for (const std::uint32_t triangles : {64u, 902u, 5000u}) {
            const auto shape = Shape::make(scenes::scene_model(kind, triangles).mesh);
            std::vector<int> reached(shape->triangles().size(), 0);
            walk(shape->data(), 0, 1, reached);
            EXPECT_EQ(std::count(reached.begin(), reached.end(), 1), triangles) << kind;
            EXPECT_LE(shape->data().triangle_blocks.size(), triangles / TRIANGLE_LANES + 2) << "blocks are full";
        }
}

// Nested pairs, each a little smaller than the last: the greedy tree becomes a list, and the fallback bounds its depth.
TEST(Bvh, StaysWithinTheTrailForNastyMeshes) {
    Mesh mesh;
    mesh.name = "nest";
    double x = 1;
    for (std::uint32_t i = 0; i < 1500; ++i) {
        x *= 0.98;
        for (const double side : {x, -x}) {
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            mesh.vertices.insert(mesh.vertices.end(), {{side, 0, side}, {side, side, 0}, {0, side, side}});
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
    }
    const auto shape = Shape::make(mesh);
    std::vector<int> reached(shape->triangles().size(), 0);
    walk(shape->data(), 0, 1, reached);
    EXPECT_EQ(std::count(reached.begin(), reached.end(), 1), 3000);
}

TEST(Bvh, SameBitsEveryTime) {
    const Mesh mesh = scenes::scene_model("knot", 902).mesh;
    const auto a = Shape::make(mesh), b = Shape::make(mesh);
    ASSERT_EQ(a->data().nodes.size(), b->data().nodes.size());
    EXPECT_EQ(
        std::memcmp(a->data().nodes.data(), b->data().nodes.data(), a->data().nodes.size() * sizeof(kernels::Node)), 0);
}

} // namespace
} // namespace raycontact
