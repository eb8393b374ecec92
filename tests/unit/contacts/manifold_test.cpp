// SPDX-License-Identifier: Apache-2.0
#include <raycontact/manifold.h>

#include "mesh/vector.h"
#include "reference/random.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace raycontact {
namespace {

ManifoldPoint point(double x, double y, double depth, bool present = false) {
    return {{x, y, 0}, {0, 0, 1}, depth, 2, 0.08, present};
}

std::vector<std::uint32_t> all_of(const std::vector<ManifoldPoint>& points) {
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

// Ascending.
std::vector<std::uint32_t> chosen_of(const std::vector<ManifoldPoint>& points) {
    auto chosen = choose_points(points, all_of(points));
    std::ranges::sort(chosen);
    return chosen;
}

TEST(ChoosePoints, UpToFourAreAllTaken) {
    std::vector<ManifoldPoint> points;
    for (std::size_t n = 0; n <= 4; ++n) {
        EXPECT_EQ(chosen_of(points).size(), n);
        points.push_back(point(double(n), 0, 1));
    }
}

TEST(ChoosePoints, CornersOfAGrid) {
    std::vector<ManifoldPoint> points;
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 5; ++j) points.push_back(point(i, j, 0.01));
    EXPECT_EQ(chosen_of(points), (std::vector<std::uint32_t>{0, 4, 20, 24}));
}

TEST(ChoosePoints, DeepestIsTheFirst) {
    std::vector<ManifoldPoint> points;
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 5; ++j) points.push_back(point(i, j, i == 2 && j == 2 ? 0.012 : 0.01, i == 0));
    const auto chosen = choose_points(points, all_of(points));
    EXPECT_EQ(chosen.size(), 4u);
    EXPECT_EQ(chosen.front(), 12u);
}

// Both ends of a row carry a torque about its middle, wherever its deepest point is.
TEST(ChoosePoints, BothEndsOfARow) {
    for (int deepest = 0; deepest < 9; ++deepest) {
        std::vector<ManifoldPoint> points;
        for (int i = 0; i < 9; ++i) points.push_back(point(i, 0, i == deepest ? 0.02 : 0.01));
        const auto chosen = chosen_of(points);
        EXPECT_EQ(chosen.front(), 0u) << deepest;
        EXPECT_EQ(chosen.back(), 8u) << deepest;
    }
}

TEST(ChoosePoints, ThosePresentStayWhileAsGood) {
    std::vector<ManifoldPoint> points;
    for (int k = 0; k < 8; ++k) {
        // Two nearly equal points at each corner of a square; the second of each was there before.
        const int x = k / 2 % 2, y = k / 4;
        points.push_back(point(x + 0.1 * (k % 2 ? 0 : x - 0.5), y, 0.01, k % 2 == 1));
    }
    EXPECT_EQ(chosen_of(points), (std::vector<std::uint32_t>{1, 3, 5, 7}));
}

TEST(ChoosePoints, OneOfThoseThatSayTheSame) {
    std::vector<ManifoldPoint> points;
    for (int k = 0; k < 16; ++k) // four at each corner
        points.push_back(point(k / 4 % 2 + 0.01 * (k % 4), k / 8, 0.01 + 0.001 * (k % 4)));
    EXPECT_EQ(chosen_of(points), (std::vector<std::uint32_t>{3, 7, 11, 15}));
    EXPECT_EQ(chosen_of(std::vector(6, point(1, 1, 0.01))).size(), 1u);
    // Not where they push in different directions.
    points = std::vector(2, point(1, 1, 0.01));
    points[1].normal = unit({1, 0, 2});
    EXPECT_FALSE(say_the_same(points[0], points[1]));
    EXPECT_EQ(chosen_of(points).size(), 2u);
}

TEST(ChooseContacts, AreSharedOutByTheDepthsOfPatches) {
    const auto chosen = [](double floor, double wall) {
        std::vector<ManifoldPoint> points;
        for (int k = 0; k < 4; ++k) points.push_back(point(k % 2, k / 2, floor));
        for (int k = 0; k < 4; ++k) {
            points.push_back(point(k % 2, k / 2, wall));
            points.back().normal = {1, 0, 0};
        }
        const std::vector<std::uint32_t> four = choose_contacts(points, 4);
        EXPECT_EQ(four.size(), 4u);
        EXPECT_EQ(choose_contacts(points, 100).size(), 8u);
        return std::ranges::count_if(four, [](std::uint32_t i) { return i < 4; });
    };
    EXPECT_EQ(chosen(0.01, 0.01), 2);
    EXPECT_EQ(chosen(0.01, 0.004), 3); // 10, 5, 4, 3.3
    EXPECT_EQ(chosen(0.01, 0.001), 4);
    EXPECT_EQ(chosen(0.001, 0.01), 0);
    EXPECT_EQ(chosen(0.001, -0.001), 4); // what does not touch comes after
    EXPECT_EQ(chosen(-0.001, -0.002), 2);
}

TEST(ChoosePoints, NumbersThatAreNoneEnd) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [at, depth] : {std::pair(nan, 1.0), std::pair(0.0, nan)}) {
        const std::vector<ManifoldPoint> points(9, point(at, at, depth));
        EXPECT_LE(choose_points(points, all_of(points)).size(), 4u);
        EXPECT_LE(choose_contacts(points, 9).size(), 9u);
    }
}

double area_of(std::vector<Vec3> corners) {
    // Of the convex hull of points in a plane: Andrew's chain.
    std::ranges::sort(corners, {}, [](const Vec3& p) { return std::pair(p.x, p.y); });
    std::vector<Vec3> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t first = hull.size();
        for (const Vec3& p : corners) {
            while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()).z <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::ranges::reverse(corners);
    }
    double twice = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) twice += cross(hull[i], hull[(i + 1) % hull.size()]).z;
    return twice / 2;
}

// The hull of the points is where a centre of pressure can lie, so its area says what torque they can give.
TEST(ChoosePoints, SpansNearlyWhatFourPointsCanSpan) {
    reference::Random random(5);
    double least = 1, sum = 0;
    constexpr int rounds = 500;
    for (int round = 0; round < rounds; ++round) {
        std::vector<ManifoldPoint> points;
        const std::size_t count = 5 + random.below(8);
        for (std::size_t i = 0; i < count; ++i) {
            ManifoldPoint& p = points.emplace_back(point(random.uniform(), random.uniform(), random.uniform()));
            if (round % 2 == 0) p.position = unit({p.position.x - 0.5, p.position.y - 0.5, 0});
        }
        const auto chosen = choose_points(points, all_of(points));
        std::vector<Vec3> corners;
        for (const std::uint32_t i : chosen) corners.push_back(points[i].position);
        double best = 0;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = i; j < count; ++j)
                for (std::size_t k = j; k < count; ++k)
                    best = std::max(best, area_of({points[chosen.front()].position, points[i].position,
                                                   points[j].position, points[k].position}));
        least = std::min(least, area_of(corners) / best);
        sum += area_of(corners) / best / rounds;
    }
    EXPECT_GT(least, 0.6);
    EXPECT_GT(sum, 0.93);
}

TEST(JoinPatches, ByNormalAndPlaceTheDeepestFirst) {
    std::vector<ManifoldPoint> points;
    for (int i = 0; i < 4; ++i) {
        points.push_back(point(0.1 * i, 0, 0.1 + i));      // a place
        points.push_back(point(10 + 0.1 * i, 0, 0.2 + i)); // another, out of reach
        points.push_back(point(0.1 * i, 0, 0.3 + i));      // another normal there
        points.back().normal = {1, 0, 0};
    }
    std::vector<ManifoldPatch> patches;
    join_patches(points, 0.8, patches);
    ASSERT_EQ(patches.size(), 3u);
    EXPECT_EQ(patches[0].points, (std::vector<std::uint32_t>{11, 8, 5, 2}));
    EXPECT_EQ(patches[1].points, (std::vector<std::uint32_t>{10, 7, 4, 1}));
    EXPECT_EQ(patches[2].points, (std::vector<std::uint32_t>{9, 6, 3, 0}));
    EXPECT_EQ(patches[0].centre, points[11].position);
    EXPECT_EQ(patches[0].normal, (Vec3{1, 0, 0}));
}

TEST(JoinPatches, PointsStayWhereTheyWere) {
    std::vector<ManifoldPoint> points{point(0, 0, 1), point(0, 0, 2)};
    points[0].patch = 1;
    std::vector<ManifoldPatch> patches{{{0, 0, 1}, {0, 0, 0}, {}}, {{0, 1, 0}, {9, 9, 9}, {}}};
    join_patches(points, 0.8, patches);
    ASSERT_EQ(patches.size(), 2u);
    EXPECT_EQ(patches[0].points, std::vector<std::uint32_t>{1});
    EXPECT_EQ(patches[1].points, std::vector<std::uint32_t>{0});
}

// The result depends on depths and on the order of equals alone.
TEST(JoinPatches, TheOrderOfUnequalPointsDoesNotMatter) {
    reference::Random random(6);
    std::vector<ManifoldPoint> points;
    for (int i = 0; i < 60; ++i) {
        ManifoldPoint& p = points.emplace_back(point(8 * random.uniform(), 8 * random.uniform(), random.uniform()));
        p.normal = unit({random.uniform() - 0.5, random.uniform() - 0.5, random.uniform()});
    }
    const auto told = [](std::span<const ManifoldPoint> list) {
        std::vector<ManifoldPatch> patches;
        join_patches(list, 0.8, patches);
        std::vector<std::vector<double>> depths;
        for (const ManifoldPatch& patch : patches) {
            std::vector<double>& own = depths.emplace_back();
            for (const std::uint32_t i : choose_points(list, patch.points)) own.push_back(list[i].depth);
        }
        return depths;
    };
    const auto once = told(points);
    EXPECT_GT(once.size(), 5u);
    std::ranges::reverse(points);
    EXPECT_EQ(told(points), once);
    std::ranges::sort(points, {}, [](const ManifoldPoint& p) { return p.position.x; });
    EXPECT_EQ(told(points), once);
}

} // namespace
} // namespace raycontact
