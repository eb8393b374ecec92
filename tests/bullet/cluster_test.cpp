// SPDX-License-Identifier: Apache-2.0
#include <cluster.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace raycontact::bullet {
namespace {

Applicant point(double x, double y, double depth, bool present = false) {
    return {btVector3(btScalar(x), btScalar(y), 0), btScalar(depth), present};
}

TEST(ChoosePoints, UpToFourAreAllTaken) {
    std::vector<Applicant> all;
    for (int n = 0; n <= 4; ++n) {
        EXPECT_EQ(choose_points(all).size(), static_cast<std::size_t>(n));
        all.push_back(point(n, 0, 1));
    }
}

TEST(ChoosePoints, CornersOfAGrid) {
    std::vector<Applicant> all;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) all.push_back(point(i, j, 0.01));
    }
    EXPECT_EQ(choose_points(all), (std::vector<int>{0, 4, 20, 24}));
}

TEST(ChoosePoints, DeepestIsAlwaysAmongThem) {
    std::vector<Applicant> all;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) all.push_back(point(i, j, i == 2 && j == 2 ? 0.1 : 0.01));
    }
    const auto chosen = choose_points(all);
    EXPECT_NE(std::find(chosen.begin(), chosen.end(), 12), chosen.end());
    EXPECT_EQ(chosen.size(), 4u);
}

TEST(ChoosePoints, ThosePresentStayWhileAsGood) {
    std::vector<Applicant> all;
    for (int k = 0; k < 8; ++k) {
        // Two nearly equal points at each corner of a square; the second of each was there before.
        const int x = k / 2 % 2, y = k / 4;
        all.push_back(point(x + 0.01 * (k % 2 ? 0 : x - 0.5), y, 0.01, k % 2 == 1));
    }
    EXPECT_EQ(choose_points(all), (std::vector<int>{1, 3, 5, 7}));
}

TEST(ChoosePoints, OneSpotOrOneLineStillGivesFour) {
    std::vector<Applicant> spot(6, point(1, 1, 0.01)), line;
    for (int i = 0; i < 6; ++i) line.push_back(point(i, 0, 0.01));
    EXPECT_EQ(choose_points(spot).size(), 4u);
    EXPECT_EQ(choose_points(line).size(), 4u);
}

} // namespace
} // namespace raycontact::bullet
