// SPDX-License-Identifier: Apache-2.0
#include "shape/angle.h"

#include <gtest/gtest.h>

namespace raycontact {
namespace {

TEST(Angle, AgreesWithTheLibrary) {
    for (double x = 1e-12; x < 1e12; x *= 1.37) EXPECT_NEAR(portable_atan(x), std::atan(x), 4e-16 * (1 + std::atan(x)));
    EXPECT_EQ(portable_atan(0), 0);
}

TEST(Angle, KnownAngles) {
    EXPECT_NEAR(angle_between({1, 0, 0}, {0, 5, 0}), M_PI / 2, 1e-15);
    EXPECT_NEAR(angle_between({1, 0, 0}, {-3, 0, 0}), M_PI, 1e-15);
    EXPECT_EQ(angle_between({1, 2, 3}, {2, 4, 6}), 0);
    EXPECT_NEAR(angle_between({1, 0, 0}, {1, 1e-9, 0}), 1e-9, 1e-20);
    EXPECT_EQ(angle_between({0, 0, 0}, {1, 0, 0}), 0);
}

} // namespace
} // namespace raycontact
