// SPDX-License-Identifier: Apache-2.0
#include "mesh/dyadic.h"

#include "reference/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace raycontact {
namespace {

int order(const Dyadic& a, const Dyadic& b) {
    return (a - b).sign();
}

TEST(Dyadic, LosesNoBit) {
    const double large = std::ldexp(1, 1000), small = std::numeric_limits<double>::denorm_min();
    const Dyadic sum = Dyadic(large) + small;
    EXPECT_EQ(order(sum, large), 1);
    EXPECT_EQ(order(sum - large, small), 0);
    EXPECT_EQ(order(sum * sum, Dyadic(large) * large + Dyadic(2) * large * small + Dyadic(small) * small), 0);
    EXPECT_EQ((Dyadic(0.1) + 0.2 - 0.3).sign(), 1) << "as the doubles are";
    EXPECT_EQ((Dyadic(-1) - std::ldexp(1, -200) + 1).sign(), -1);
    EXPECT_EQ((Dyadic(large) - large).sign(), 0);
    EXPECT_EQ((Dyadic(-0.0) + 0.0).sign(), 0);
    EXPECT_EQ((Dyadic() * 5 - Dyadic() + 3).sign(), 1);
}

TEST(Dyadic, FollowsTheRulesOfArithmetic) {
    reference::Random random(61);
    const auto any = [&] {
        return Dyadic(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(400)) - 200));
    };
    for (int i = 0; i < 10000; ++i) {
        const Dyadic a = any(), b = any(), c = any();
        ASSERT_EQ(order((a + b) * (a - b), a * a - b * b), 0) << i;
        ASSERT_EQ(order(a * (b + c), a * b + a * c), 0) << i;
        ASSERT_EQ(order(a + b - a, b), 0) << i;
        ASSERT_EQ(order(a, b), -order(b, a)) << i;
    }
}

TEST(Dyadic, ARatioIsRightToRounding) {
    reference::Random random(62);
    for (int i = 0; i < 10000; ++i) {
        const double p = random.uniform(-1, 1),
                     q = std::ldexp(random.uniform(0.1, 1), static_cast<int>(random.below(60)));
        // Sums that cancel, and products far beyond what a double holds.
        const Dyadic far = std::ldexp(1, 900), a = (Dyadic(p) + far - far) * far * far, b = (far + q - far) * far * far;
        ASSERT_NEAR(ratio(a, b), p / q, 4e-16 * std::fabs(p / q)) << i;
    }
    EXPECT_EQ(ratio(0, 7), 0);
    EXPECT_EQ(ratio(-6, 3), -2);
}

} // namespace
} // namespace raycontact
