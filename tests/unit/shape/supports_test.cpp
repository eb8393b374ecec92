// SPDX-License-Identifier: Apache-2.0
// No vertex reaches farther than the table says, and hardly any much less.
#include "property/crowds.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "shape/accelerators.h"

#include <mesh/vector.h>

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>

namespace raycontact {
namespace {

double reach_along(const ShapeData& shape, const Vec3& direction) {
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t v = 0; v < shape.points.size(); ++v) most = std::max(most, dot(shape.point(v), direction));
    return most;
}

TEST(Supports, ReachNoLessThanAnyVertexAndHardlyMore) {
    reference::Random random(1);
    double most_over = 0, over = 0; // in reaches of the shape
    std::size_t asked = 0;
    for (const auto& shape : reference::crowd_shapes(reference::Kind::sizes, 0.1)) {
        shape->prepare();
        const ShapeData& data = shape->data();
        const Supports& supports = accelerators_of(*shape)->supports;
        for (int i = 0; i < 3000; ++i) {
            Vec3 direction = random.direction();
            // On and near the borders of the cube's faces and of the grid's cells, too.
            if (i % 3 == 0) direction = {direction.x, direction.x, direction.z};
            if (i % 5 == 0) direction = {1, (1.0 / 8) * double(random.below(17)) - 1, i % 2 ? 0.25 : 1e-9};
            direction = (i % 7 + 0.1) * direction; // of any length
            const double size = length(direction), told = dot(supports.point(direction), direction) / size;
            const double reach = reach_along(data, (1 / size) * direction);
            ASSERT_GE(told, reach);
            most_over = std::max(most_over, (told - reach) / data.reach);
            over += (told - reach) / data.reach;
            ++asked;
        }
    }
    over /= double(asked);
    std::printf("[ counts   ] %.4f of a shape's reach too far in the mean, %.4f at most\n", over, most_over);
    EXPECT_LT(over, 0.003);
    // Of a needle half a cell, across its length.
    EXPECT_LT(most_over, 0.07);
}

TEST(Supports, KnowNothingWhenStopped) {
    const auto shape = Shape::make(reference::box_mesh({1, 2, 3}));
    Executor executor(1);
    std::stop_source stop;
    EXPECT_GT(Supports(shape->data(), executor, stop.get_token()).bytes(), 0u);
    stop.request_stop();
    EXPECT_EQ(Supports(shape->data(), executor, stop.get_token()).bytes(), 0u);
}

} // namespace
} // namespace raycontact
