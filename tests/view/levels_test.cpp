// SPDX-License-Identifier: Apache-2.0
#include "reference/meshes.h"

#include <view/levels.h>

#include <cmath>
#include <gtest/gtest.h>

namespace raycontact::view {
namespace {

TEST(Levels, TheFinestIsTheShapeItself) {
    const auto shape = Shape::make(reference::bumpy_octahedron_mesh(20));
    const Levels levels = make_levels(*shape, 1'000'000);
    ASSERT_EQ(levels.triangles.front().size(), 3 * shape->triangles().size());
    for (std::size_t t = 0; t < shape->triangles().size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 v = shape->vertices()[shape->triangles()[t][c]];
            const auto& own = levels.vertices[levels.triangles.front()[3 * t + c]];
            const double place[3] = {v.x, v.y, v.z};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double extent = double(levels.high[axis]) - double(levels.low[axis]);
                EXPECT_NEAR(double(levels.low[axis]) + own[axis] / 65535.0 * extent, place[axis], extent / 65535);
            }
        }
}

TEST(Levels, EachHasAboutAQuarterAndTheLastAboutAHundred) {
    const auto shape = Shape::make(reference::bumpy_octahedron_mesh(40)); // 12 800 triangles
    const Levels levels = make_levels(*shape, 1'000'000);
    ASSERT_GE(levels.triangles.size(), 4u);
    for (std::size_t i = 1; i < levels.triangles.size(); ++i)
        EXPECT_LE(levels.triangles[i].size(), levels.triangles[i - 1].size() / 2);
    EXPECT_LE(levels.triangles.back().size(), 3 * 2 * coarsest);
    EXPECT_GE(levels.triangles.back().size(), 3 * coarsest / 4);
}

TEST(Levels, TheFinestCanBeBounded) {
    const auto shape = Shape::make(reference::bumpy_octahedron_mesh(40));
    const Levels levels = make_levels(*shape, 1000);
    EXPECT_LE(levels.triangles.front().size(), 3u * 1000);
    EXPECT_GE(levels.triangles.front().size(), 3u * 500);
    for (const auto& level : levels.triangles)
        for (const std::uint32_t v : level) ASSERT_LT(v, levels.vertices.size());
}

TEST(Levels, AFewTrianglesAreOneLevelAndAFlatShapeIsFine) {
    EXPECT_EQ(make_levels(*Shape::make(reference::l_prism_mesh()), 1000).triangles.size(), 1u);
    const Levels sheet = make_levels(*Shape::make(reference::sheet_mesh(30)), 1'000'000);
    EXPECT_GE(sheet.triangles.size(), 2u);
}

} // namespace
} // namespace raycontact::view
