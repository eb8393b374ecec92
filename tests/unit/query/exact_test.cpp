// SPDX-License-Identifier: Apache-2.0
// Whether meshes touch, where the answer is known in real numbers: of doubles that float32 cannot hold.
#include <raycontact/query.h>

#include "reference/meshes.h"
#include "reference/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace raycontact {
namespace {

using namespace reference;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::array edges{0.7,   25.4,  1.1, 0.1, 0.3, 1.0 / 3, 12.7, 2.54, 0.001,
                           0.007, 100.1, 3.3, 5.9, 0.9, 1.7,     2.2,  33.3, 254.0};

/// The box between two corners.
Mesh box_between(const Vec3& low, const Vec3& high) {
    Mesh mesh = box_mesh({1, 1, 1});
    for (Vec3& v : mesh.vertices) v = {v.x < 0 ? low.x : high.x, v.y < 0 ? low.y : high.y, v.z < 0 ? low.z : high.z};
    return mesh;
}

std::vector<Vec3> directions() {
    std::vector<Vec3> all;
    for (int i = 0; i < 27; ++i)
        if (i != 13) all.push_back({double(i / 9 - 1), double(i / 3 % 3 - 1), double(i % 3 - 1)});
    return all;
}

Vec3 scaled(const Vec3& v, double by) {
    return {v.x * by, v.y * by, v.z * by};
}

bool both_ways(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const bool answer = intersects(a, pose_a, b, pose_b);
    EXPECT_EQ(answer, intersects(b, pose_b, a, pose_a));
    const auto apart = distance(a, pose_a, b, pose_b);
    EXPECT_TRUE(apart && (apart->distance == 0) == answer);
    return answer;
}

/// Of a pair of boxes that touch, and of pairs a last bit farther apart and nearer.
struct Answers {
    int asked = 0, touching = 0, gaps_seen = 0, overlapping = 0;
};

// Faces, edges and corners of boxes that lie where their files say, as in one assembly.
TEST(Exact, BoxesOfOneAssemblyTouch) {
    Answers answers;
    for (const double e : edges) {
        const auto first = Shape::make(box_between({0, 0, 0}, {e, e, e}));
        EXPECT_EQ(first->file_vertices().size(), 8u);
        for (const Vec3& way : directions()) {
            const auto beside = [&](double near) { // how far the near side of the second is out
                const auto low = [&](double d) { return d > 0 ? near : d < 0 ? -e : 0; };
                const auto high = [&](double d) { return d > 0 ? 2 * e : d < 0 ? e - near : e; };
                return Shape::make(
                    box_between({low(way.x), low(way.y), low(way.z)}, {high(way.x), high(way.y), high(way.z)}));
            };
            // Towards lower numbers the second box ends at 0, or at a tiny number above or below.
            ++answers.asked;
            answers.touching += both_ways(*first, {}, *beside(e), {});
            answers.gaps_seen += !both_ways(*first, {}, *beside(std::nextafter(e, infinite)), {});
            answers.overlapping += both_ways(*first, {}, *beside(std::nextafter(e, 0)), {});
            const Random seed(7);
            Random random = seed;
            Pose anywhere = random.rotation();
            anywhere.translation = scaled(random.in_ball(), 100);
            EXPECT_TRUE(both_ways(*first, anywhere, *beside(e), anywhere)) << e;
        }
    }
    EXPECT_EQ(answers.asked, 468);
    EXPECT_EQ(answers.touching, 468);
    EXPECT_EQ(answers.gaps_seen, 468);
    EXPECT_EQ(answers.overlapping, 468);
}

// One box, moved by its edge: what rounds in the sum must not decide.
TEST(Exact, ABoxMovedByItsEdgeTouchesItself) {
    for (const double e : edges) {
        for (const bool centred : {false, true}) {
            const auto box =
                centred ? Shape::make(box_mesh({e / 2, e / 2, e / 2})) : Shape::make(box_between({0, 0, 0}, {e, e, e}));
            for (const Vec3& way : directions()) {
                const double out = std::nextafter(e, infinite), in = std::nextafter(e, 0);
                EXPECT_TRUE(both_ways(*box, {}, *box, {.translation = scaled(way, e)})) << e;
                EXPECT_TRUE(both_ways(*box, {}, *box, {.translation = scaled(way, in)})) << e;
                EXPECT_FALSE(both_ways(*box, {}, *box, {.translation = scaled(way, out)})) << e;
                // By the same numbers, but from elsewhere: both translations are exact, and so is their difference.
                const Vec3 from{1024, -512, 2048};
                const Pose there{.translation = from};
                Vec3 to = scaled(way, e);
                to = {from.x + to.x, from.y + to.y, from.z + to.z};
                const double gap =
                    std::max({std::fabs(to.x - from.x), std::fabs(to.y - from.y), std::fabs(to.z - from.z)});
                EXPECT_EQ(both_ways(*box, there, *box, {.translation = to}), gap <= e) << e;
            }
        }
    }
}

TEST(Exact, QuarterTurnsAreExact) {
    const std::array<Pose, 4> turns{Pose{}, Pose{.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1}},
                                    Pose{.rotation = {1, 0, 0, 0, 0, -1, 0, 1, 0}},
                                    Pose{.rotation = {0, 0, 1, 0, 1, 0, -1, 0, 0}}};
    for (const double e : edges) {
        const auto box = Shape::make(box_mesh({e / 2, e / 2, e / 2}));
        for (const Pose& turn_a : turns)
            for (Pose turn_b : turns)
                for (const Vec3& way : directions()) {
                    turn_b.translation = scaled(way, e);
                    EXPECT_TRUE(both_ways(*box, turn_a, *box, turn_b)) << e;
                    turn_b.translation = scaled(way, std::nextafter(e, infinite));
                    EXPECT_FALSE(both_ways(*box, turn_a, *box, turn_b)) << e;
                }
    }
}

// The tip of a turned spike is moved to a wall, by its place rounded to double. What was rounded off is known, and it
// alone decides: some 1e-17 m.
TEST(Exact, OfTurnedMeshesWhatWasRoundedOffDecides) {
    Random random(11);
    const auto wall = Shape::make(box_between({0, -9, -9}, {1, 9, 9}));
    int meeting = 0;
    constexpr int count = 2000;
    for (int i = 0; i < count; ++i) {
        const double tip = random.uniform(0.5, 3);
        Mesh mesh;
        mesh.vertices = {{tip, 0, 0}, {-tip, 0.1, 0}, {-tip, -0.1, 0.1}, {-tip, -0.1, -0.1}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
        const auto spike = Shape::make(mesh);
        const double angle = random.uniform(-0.3, 0.3), c = std::cos(angle), s = std::sin(angle);
        const double x = c * tip, off = std::fma(c, tip, -x); // x + off is exact
        const Pose pose{.rotation = {c, -s, 0, s, c, 0, 0, 0, 1}, .translation = {-x, 0, 0}};
        EXPECT_EQ(both_ways(*spike, pose, *wall, {}), off >= 0) << i;
        meeting += off >= 0;
        EXPECT_EQ(contains(*wall, transform_point(pose, mesh.vertices[0])), true); // rounded, it is on the wall
    }
    EXPECT_GT(meeting, count / 3);
    EXPECT_LT(meeting, 2 * count / 3);
}

TEST(Exact, CornersEdgesAndFacesAreContained) {
    for (const double e : edges) {
        const auto box = Shape::make(box_between({0, 0, 0}, {e, e, e}));
        for (int i = 0; i < 27; ++i) {
            const Vec3 p{e * (i / 9) / 2, e * (i / 3 % 3) / 2, e * (i % 3) / 2};
            EXPECT_TRUE(contains(*box, p)) << e << " " << i;
            const Pose moved{.translation = {-p.x, -p.y, -p.z}};
            EXPECT_TRUE(contains(*box, moved, {})) << e << " " << i;
            if (i / 9 != 2) continue;
            const double out = std::nextafter(e, infinite);
            EXPECT_FALSE(contains(*box, {out, p.y, p.z})) << e << " " << i;
            EXPECT_FALSE(contains(*box, {.translation = {-out, -p.y, -p.z}}, {})) << e << " " << i;
        }
    }
}

TEST(Exact, WhatIsNotRoundedIsNotKept) {
    const auto plain = Shape::make(box_mesh({0.5, 0.25, 2}));
    EXPECT_EQ(plain->file_vertices().data(), plain->vertices().data());
    const auto odd = Shape::make(box_between({0, 0, 0}, {0.7, 1.1, 25.4}));
    EXPECT_NE(odd->file_vertices().data(), odd->vertices().data());
    Mesh mesh = box_mesh({1, 1, 1});
    mesh.vertices.assign(odd->vertices().begin(), odd->vertices().end());
    EXPECT_EQ(odd->memory_bytes(), Shape::make(mesh)->memory_bytes() + 8 * sizeof(Vec3));
    for (std::size_t i = 0; i < 8; ++i) {
        const Vec3 exact = odd->file_vertices()[i], rounded = odd->vertices()[i];
        EXPECT_TRUE((exact.x == 0 || exact.x == 0.7) && (exact.y == 0 || exact.y == 1.1));
        EXPECT_NEAR(exact.z, rounded.z, 1e-5);
    }
}

// Three vertices that float32 puts on one line: a square with a slot of 1e-9 m closed by them.
TEST(Exact, TrianglesThatRoundingFlattensAreThere) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}};
    const auto sheet = Shape::make(mesh);
    const auto hit = raycast(*sheet, {}, {0.5, 5e-10, 1}, {0, 0, -1});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->triangle, 0u);
    EXPECT_DOUBLE_EQ(hit->distance, 1);
    EXPECT_DOUBLE_EQ(hit->normal.z, 1);
    const auto needle = Shape::make(box_between({0.5 - 1e-10, 2e-10, -1}, {0.5 + 1e-10, 4e-10, 1e-3}));
    EXPECT_TRUE(both_ways(*sheet, {}, *needle, {}));
    const auto nearest = closest_point(*sheet, {}, {0.5, 5e-10, 1e-3});
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(nearest->distance, 1e-3, 1e-9);
}

} // namespace
} // namespace raycontact
