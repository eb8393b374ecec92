// SPDX-License-Identifier: Apache-2.0
#include <reproduce/pair_lengths.h>
#include <reproduce/phases.h>
#include <reproduce/series.h>

#include <gtest/gtest.h>

namespace raycontact::reproduce {
namespace {

TEST(Series, WindowsKeepTheSumAndCoverAllSteps) {
    Series values(1000, 0);
    values[999] = 5; // windows of five steps
    const report::Line found = line("name", values);
    ASSERT_EQ(found.points.size(), 200u);
    EXPECT_EQ(found.points.front().first, 0);
    EXPECT_EQ(found.points.back().first, 999);
    EXPECT_EQ(found.points.back().second, 1);
    EXPECT_EQ(found.points[1].first, 7);
}

TEST(Series, PercentOfNothingIsZero) {
    EXPECT_EQ(percent_line("", {1, 1}, {4, 0}).points[0].second, 25);
    EXPECT_EQ(percent_line("", {1, 1}, {4, 0}).points[1].second, 0);
}

TEST(Series, RankCorrelationLooksAtTheOrderAlone) {
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4}, {1, 10, 100, 1000}), 1, 1e-12);
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4}, {8, 7, 0, -1}), -1, 1e-12);
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4, 5}, {2, 1, 4, 3, 5}), 0.8, 1e-12); // 1 - 6 x 4 / (5 x 24)
    EXPECT_NEAR(rank_correlation({1, 1, 2}, {5, 5, 9}), 1, 1e-12);
    EXPECT_EQ(rank_correlation({1, 1, 1}, {5, 6, 9}), 0);
    EXPECT_EQ(rank_correlation({}, {}), 0);
}

TEST(Phases, SecondsWithManyFullLooksAreB) {
    Series full(180, 1), pairs(180, 10);
    for (std::size_t i = 60; i < 120; ++i) full[i] = 9;
    const std::vector<Phase> found = phases(full, pairs);
    EXPECT_EQ(found[59], Phase::c);
    EXPECT_EQ(found[60], Phase::b);
    EXPECT_EQ(found[119], Phase::b);
    EXPECT_EQ(found[120], Phase::c);
    Series slow(180, 1), fast(180, 1);
    for (std::size_t i = 60; i < 120; ++i) slow[i] = 3;
    EXPECT_NEAR(speed_up(slow, fast, found, Phase::b), 3, 1e-6);
    EXPECT_NEAR(speed_up(slow, fast, found, Phase::c), 1, 1e-6);
    EXPECT_NEAR(best_second(slow, fast), 3, 1e-6);
}

TEST(Series, SharesAndDifferencesAreFinite) {
    EXPECT_DOUBLE_EQ(share(1, 4), 25);
    EXPECT_DOUBLE_EQ(share(0, 0), 0);
    EXPECT_DOUBLE_EQ(less_by(4, 1), 75);
    EXPECT_DOUBLE_EQ(less_by(4, 6), -50);
    EXPECT_DOUBLE_EQ(less_by(0, 1), 0);
}

TEST(PairLengths, KnowsThePairThatIsLongest) {
    const auto contact = [](std::uint32_t a, std::uint32_t b, float ray, float depth) {
        Contact c;
        c.body_a = {a};
        c.body_b = {b};
        c.ray_length = ray;
        c.depth = depth;
        return c;
    };
    PairLengths pairs;
    EXPECT_EQ(pairs.longest_ray(), 0);
    for (int step = 0; step < 3; ++step) pairs.add(std::vector{contact(0, 1, 2, 1), contact(1, 2, 1, 0.5F)});
    pairs.add(std::vector{contact(0, 2, 4, 4), contact(1, 2, 0.5F, 0.25F)});
    EXPECT_EQ(pairs.longest_ray(), 6);
    EXPECT_EQ(pairs.longest_depth(), 4);
}

TEST(Phases, WithoutPairsOrDifferencesEverythingIsFinite) {
    EXPECT_EQ(phases({0, 0}, {0, 0})[0], Phase::c);
    EXPECT_EQ(phases({1, 1}, {2, 2})[0], Phase::b);
    EXPECT_EQ(speed_up({0, 0}, {0, 0}, {Phase::c, Phase::c}, Phase::b), 1);
    EXPECT_EQ(best_second({0}, {0}), 1);
}

} // namespace
} // namespace raycontact::reproduce
