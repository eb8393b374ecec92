// SPDX-License-Identifier: Apache-2.0
#include "shape/accelerators.h"

#include <gtest/gtest.h>

namespace raycontact {
namespace {

Mesh cube(double half) {
    Mesh mesh;
    mesh.name = "cube";
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

// Eight cells an edge: whether the upper corner is in the eighth or the ninth is a matter of rounding.
TEST(OutsideGrid, HoldsTheCellOfTheUpperCorner) {
    for (int i = 1; i <= 200; ++i) {
        const auto shape = Shape::make(cube(0.01 * i));
        shape->prepare();
        const kernels::ShapeHeader& header = accelerators_of(*shape)->header;
        ASSERT_GT(header.grid_size[0], 0u);
        for (int axis = 0; axis < 3; ++axis) // as the kernels look it up
            EXPECT_LT(static_cast<int>((header.high[axis] - header.grid_low[axis]) * header.grid_scale),
                      static_cast<int>(header.grid_size[axis]))
                << "half " << 0.01 * i << ", axis " << axis;
    }
}

} // namespace
} // namespace raycontact
