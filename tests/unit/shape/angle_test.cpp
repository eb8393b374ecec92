// SPDX-License-Identifier: Apache-2.0
#include "shape/angle.h"

#include <gtest/gtest.h>

#include <limits>

namespace raycontact {
namespace {

constexpr double pi = 3.141592653589793;

TEST(Angle, AgreesWithTheLibrary) {
    for (double x = 1e-12; x < 1e12; x *= 1.37) {
        const std::array<double, 3> numbers{x, 3 * x, 0.1 * x}, found = portable_atan(numbers);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(found[i], std::atan(numbers[i]), 4e-16 * (1 + std::atan(numbers[i])));
    }
    const std::array<double, 3> ends = portable_atan({0, 1, std::numeric_limits<double>::infinity()});
    EXPECT_EQ(ends[0], 0);
    EXPECT_NEAR(ends[1], pi / 4, 1e-15);
    EXPECT_EQ(ends[2], pi / 2);
}

void expect_angles(const std::array<Vec3, 3>& corners, const std::array<double, 3>& angles, double tolerance) {
    const std::array<double, 3> found = corner_angles(corners);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], angles[i], tolerance) << "corner " << i;
}

TEST(Angle, KnownTriangles) {
    expect_angles({{{0, 0, 0}, {5, 0, 0}, {0, 5, 0}}}, {pi / 2, pi / 4, pi / 4}, 1e-15);
    expect_angles({{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}}, {0, pi, 0}, 0);
    expect_angles({{{0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}}}, {1e-9, pi / 2, pi / 2 - 1e-9}, 1e-15);
    EXPECT_NEAR(corner_angles({{{0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}}})[0], 1e-9, 1e-20);
}

TEST(Angle, ASideOfLengthZeroGivesNone) {
    expect_angles({{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}}, {0, 0, 0}, 0);
}

} // namespace
} // namespace raycontact
