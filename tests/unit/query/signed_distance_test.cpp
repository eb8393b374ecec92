// SPDX-License-Identifier: Apache-2.0
#include "unit/mesh/solids.h"
#include "unit/query/brute_force.h"

#include <raycontact/error.h>
#include <raycontact/query.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace raycontact;
using namespace raycontact::test;

namespace {

const Pose turned{.rotation = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6}, .translation = {3, -1, 2}};

std::vector<Vec3> random_points(std::size_t count, std::uint32_t seed, double size) {
    std::mt19937 random(seed);
    const auto unit = [&] { return size * (double(random()) / 2147483648.0 - 1); };
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back({unit(), unit(), unit()});
    return points;
}

Mesh two_boxes_in_each_other() {
    Mesh mesh = box();
    append(mesh, box(), {0.4, 0.3, 0.2});
    return mesh;
}

TEST(SignedDistance, IsThatOfBruteForce) {
    Mesh cavity = box(3);
    Mesh inner = box();
    turn_over(inner);
    append(cavity, inner, {1, 1, 1});
    for (const Mesh& mesh : {torus(30, 15, 1, 0.4, 0.3), box(), cavity, two_boxes_in_each_other()}) {
        const auto shape = Shape::make(mesh);
        ASSERT_TRUE(shape->has_inside());
        std::vector<Vec3> points = random_points(3000, 1, 1.5);
        for (Vec3& p : points) p = transform_point(turned, {p.x + 0.5, p.y + 0.5, p.z + 0.5});
        // Of the union, where parts lie in each other.
        const auto vertices = shape->file_vertices();
        const auto faces = shape->triangles();
        const auto triangles =
            brute::placed({"", {vertices.begin(), vertices.end()}, {faces.begin(), faces.end()}}, turned);
        const std::vector<SignedDistance> found = signed_distance(*shape, turned, points);
        std::size_t inside = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const SignedDistance& d = found[i];
            const bool is_inside = std::round(brute::winding(triangles, points[i])) >= 1;
            inside += is_inside;
            EXPECT_NEAR(d.distance, (is_inside ? -1 : 1) * brute::distance(points[i], triangles), 1e-12);
            const auto numbers = shape->triangle_index(); // pieces of a triangle have its number
            const auto [first, last] = std::equal_range(numbers.begin(), numbers.end(), d.triangle);
            double nearest = std::numeric_limits<double>::infinity();
            for (auto t = first; t != last; ++t)
                nearest = std::min(nearest, brute::distance(d.point, triangles[std::size_t(t - numbers.begin())]));
            EXPECT_NEAR(nearest, 0, 1e-12);
            // Along the gradient one comes to the point, and the distance grows.
            EXPECT_NEAR(points[i].x - d.distance * d.gradient.x, d.point.x, 1e-12);
            EXPECT_NEAR(points[i].y - d.distance * d.gradient.y, d.point.y, 1e-12);
            EXPECT_NEAR(points[i].z - d.distance * d.gradient.z, d.point.z, 1e-12);
            EXPECT_NEAR(std::hypot(d.gradient.x, d.gradient.y, d.gradient.z), 1, 1e-12);
        }
        EXPECT_GT(inside, 50u);
    }
}

// The same as of single points, in whatever order and by however many threads.
TEST(SignedDistance, OfManyPointsIsThatOfEach) {
    const auto shape = Shape::make(torus(60, 30, 1, 0.4, 0.2));
    const std::vector<Vec3> points = random_points(5000, 2, 1.4);
    const std::vector<SignedDistance> found = signed_distance(*shape, {}, points, 1);
    const std::vector<SignedDistance> threads = signed_distance(*shape, {}, points, 5);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto closest = closest_point(*shape, {}, points[i]);
        EXPECT_EQ(std::fabs(found[i].distance), closest->distance);
        EXPECT_EQ(found[i].distance < 0, contains(*shape, points[i]));
        EXPECT_EQ(found[i].triangle, closest->triangle);
        EXPECT_EQ(found[i].point, closest->point);
        EXPECT_EQ(found[i].distance, threads[i].distance);
        EXPECT_EQ(found[i].gradient, threads[i].gradient);
        const std::vector<SignedDistance> alone = signed_distance(*shape, {}, std::span(&points[i], 1));
        EXPECT_EQ(alone[0].distance, found[i].distance);
    }
}

TEST(SignedDistance, OnTheSurfaceIsZeroWithTheFacesNormal) {
    const auto shape = Shape::make(box());
    const std::vector<Vec3> points{{1, 0.5, 0.25}, {0.5, 0.25, 0}, {1, 1, 1}, {1, 0.5, 1}};
    const std::vector<SignedDistance> found = signed_distance(*shape, {}, points);
    for (const SignedDistance& d : found) {
        EXPECT_EQ(d.distance, 0);
        EXPECT_FALSE(std::signbit(d.distance));
    }
    EXPECT_EQ(found[0].gradient, (Vec3{1, 0, 0}));
    EXPECT_EQ(found[1].gradient, (Vec3{0, 0, -1}));
}

/// A tetrahedron a, b, c, d, outward, with a vertex nearly on the edge from a to b: the first face is a needle.
Mesh with_needle(const std::vector<Vec3>& corners) {
    return {"needle", corners, {{0, 1, 4}, {1, 2, 4}, {2, 0, 4}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
}

// In double the normal of a needle may be turned over, or zero.
TEST(SignedDistance, BesideANeedleItsExactNormalTellsTheSide) {
    const auto turned_over = Shape::make(with_needle({{-0.45965587724252066, 0.33283875707413163, -0.10894832405934592},
                                                      {1.4387433191070917, 1.2164939413221438, -0.0918539343463328},
                                                      {-0.4112487749637319, -0.9386885824959752, -0.5325452621953985},
                                                      {-0.4178049772671864, -0.3363948218761836, 0.6485125595410481},
                                                      {0.6972227968317419, 0.8713355283840913, -0.09853105516072523}}));
    const Vec3 outside{0.6517484741579802, 0.8915272540032726, -0.19124847933330402};
    const SignedDistance d = signed_distance(*turned_over, {}, std::span(&outside, 1))[0];
    EXPECT_FALSE(contains(*turned_over, outside));
    EXPECT_EQ(d.triangle, 0u);
    EXPECT_NEAR(d.distance, 0.09976194989336054, 1e-15);
    const auto hit =
        raycast(*turned_over, {}, outside, {d.point.x - outside.x, d.point.y - outside.y, d.point.z - outside.z});
    ASSERT_TRUE(hit && hit->triangle == 0);
    EXPECT_NEAR(std::hypot(hit->normal.x - d.gradient.x, hit->normal.y - d.gradient.y, hit->normal.z - d.gradient.z), 0,
                1e-12);

    const auto zero = Shape::make(with_needle({{-0.8166383524576908, 0.8857065749330504, 1.0021008097398598},
                                               {-0.4678733488362045, 1.9245897945636201, -0.21990606075893673},
                                               {-0.7971898991784463, 0.14702214039854083, 0.007401235582690127},
                                               {0.2698334281517525, 1.244921353787161, -1.4498645880824839},
                                               {-0.586559060063065, 1.5710549142769423, 0.19594631273971141}}));
    const Vec3 on{-0.547761537155973, 1.6866229761320282, 0.06000710135523969};
    const SignedDistance at = signed_distance(*zero, {}, std::span(&on, 1))[0];
    EXPECT_EQ(at.triangle, 0u);
    EXPECT_NEAR(std::hypot(at.gradient.x, at.gradient.y, at.gradient.z), 1, 1e-12);
}

TEST(SignedDistance, OfASheetIsNeverNegative) {
    Mesh mesh = box();
    mesh.triangles.resize(6);
    const auto shape = Shape::make(mesh);
    ASSERT_FALSE(shape->has_inside());
    for (const SignedDistance& d : signed_distance(*shape, {}, random_points(500, 3, 2))) EXPECT_GE(d.distance, 0);
}

TEST(SignedDistance, TakesPointsFarAwayAndNone) {
    const auto shape = Shape::make(box());
    EXPECT_TRUE(signed_distance(*shape, {}, {}).empty());
    const std::vector<Vec3> points{{1e30, 0, 0}, {1e20, 1e20, 0}, {0.5, 0.5, 0.5}, {-1e12, 0, 0}};
    const std::vector<SignedDistance> found = signed_distance(*shape, {}, points);
    EXPECT_DOUBLE_EQ(found[0].distance, 1e30);
    EXPECT_DOUBLE_EQ(found[1].distance, std::sqrt(2) * 1e20);
    EXPECT_DOUBLE_EQ(found[2].distance, -0.5);
    EXPECT_DOUBLE_EQ(found[3].distance, 1e12);
}

TEST(SignedDistance, RefusesWhatIsNoPoint) {
    const auto shape = Shape::make(box());
    const std::vector<Vec3> points{{0, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}};
    EXPECT_THROW(signed_distance(*shape, {}, points), InputError);
    EXPECT_THROW(signed_distance(*shape, {.rotation = {2, 0, 0, 0, 1, 0, 0, 0, 1}}, {}), InputError);
    EXPECT_THROW(signed_distance(*shape, {}, {}, 100'000), InputError);
}

} // namespace
