// SPDX-License-Identifier: Apache-2.0
#include <scenes/quantile.h>

#include <gtest/gtest.h>

using raycontact::scenes::quantile;

TEST(Quantile, IsTheMedianAndWhatLiesBetween) {
    EXPECT_EQ(quantile({}, 0.5), 0);
    EXPECT_EQ(quantile({7}, 0.5), 7);
    EXPECT_EQ(quantile({4.56, 0.4, 0.3}, 0.5), 0.4);
    EXPECT_EQ(quantile({5, 0}, 0.5), 2.5);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 0), 1);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 1), 4);
    EXPECT_DOUBLE_EQ(quantile({0, 10, 20}, 0.95), 19);
}
