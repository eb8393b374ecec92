// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/trigonometry.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using raycontact::scenes::sine_cosine;

TEST(Trigonometry, AgreesWithTheLibraryToItsLastDigits) {
    for (int k = -4000; k <= 4000; ++k) {
        const double turns = k / 1000.0;
        const auto [sine, cosine] = sine_cosine(turns);
        EXPECT_NEAR(sine, std::sin(2 * std::numbers::pi * turns), 1e-14) << turns;
        EXPECT_NEAR(cosine, std::cos(2 * std::numbers::pi * turns), 1e-14) << turns;
    }
}

TEST(Trigonometry, QuarterTurnsAreExact) {
    const double sines[] = {0, 1, 0, -1}, cosines[] = {1, 0, -1, 0};
    for (int k = -8; k <= 8; ++k) {
        const auto [sine, cosine] = sine_cosine(k / 4.0);
        EXPECT_EQ(sine, sines[(k + 8) % 4]);
        EXPECT_EQ(cosine, cosines[(k + 8) % 4]);
    }
}
