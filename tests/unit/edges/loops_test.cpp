// SPDX-License-Identifier: Apache-2.0
// Two beams laid across each other: where their surfaces cross, by hand. exact_test has the contacts of many more.
#include "edges/loops.h"

#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raycontact {
namespace {

using namespace reference;

constexpr double slack = 1e-5; // some perturbations, and float32

struct Beams {
    std::shared_ptr<const Shape> along_x, along_y;
    PlacedBody a, b;
    explicit Beams(double height)
        : along_x(Shape::make(box_mesh({2, 0.5, 0.5}))), along_y(Shape::make(box_mesh({0.5, 2, 0.5}))),
          a(placed(*along_x, 0)), b(placed(*along_y, height)) {}

    static PlacedBody placed(const Shape& shape, double height) {
        PlacedBody body;
        body.shape = &shape;
        body.pose.translation = {0, 0, height};
        body.centred = centred_pose(shape, body.pose);
        return body;
    }
};

// By brute force; the frame is b's, about its centre.
std::vector<Crossing> all_crossings(const PairMeshes& pair) {
    std::vector<Crossing> found;
    for (std::uint32_t side = 0; side < 2; ++side)
        for (std::uint32_t t = 0; t < pair.shape(side).mesh.triangles.size(); ++t)
            for (std::uint32_t k = 0; k < 3; ++k) {
                if (edge_of(pair.shape(side), t, k) != 3 * t + k) continue; // of two triangles the lower one asks
                for (std::uint32_t f = 0; f < pair.shape(1 - side).mesh.triangles.size(); ++f) {
                    PlacedFace face;
                    face.set(pair, 1 - side, f);
                    Crossing crossing;
                    if (crosses(pair, side, 3 * t + k, face, crossing)) found.push_back(crossing);
                }
            }
    return found;
}

TEST(Loops, BeamsAcrossEachOtherCrossInOneClosedLoop) {
    const Beams beams(0.8); // 0.2 of overlap, over the square of 1 m that they share
    const PairMeshes pair(beams.a, beams.b);
    const auto crossings = all_crossings(pair);
    ASSERT_GE(crossings.size(), 8u);
    Loops loops;
    for (const Crossing& seed : crossings) loops.follow(pair, seed);
    ASSERT_EQ(loops.loops().size(), 1u) << "each seed lies on the one loop";
    const Loop& loop = loops.loops()[0];
    EXPECT_TRUE(loop.is_closed());
    EXPECT_EQ(loop.count, crossings.size());
    // a leaves b downwards; seen from there the loop goes around the square.
    EXPECT_NEAR(loop.area.z, -1, slack);
    EXPECT_NEAR(loop.area.x, 0, slack);
    EXPECT_NEAR(loop.area.y, 0, slack);
    for (const Crossing& c : loops.crossings()) {
        EXPECT_LT(std::fabs(c.point.x), 0.5 + slack);
        EXPECT_LT(std::fabs(c.point.y), 0.5 + slack);
        EXPECT_GT(c.point.z, -0.5 - slack); // the lower side of b
        EXPECT_LT(c.point.z, -0.3 + slack); // the upper side of a
    }
    for (const LoopSegment& s : loops.segments()) {
        const double turn = dot(s.normals[0], s.normals[1]);
        EXPECT_TRUE(std::fabs(turn) < slack || std::fabs(turn + 1) < slack) << "no two faces of these look alike";
    }
}

TEST(Loops, EveryTriangleOfALoopHasTwoCrossings) {
    const Beams beams(0.8);
    const PairMeshes pair(beams.a, beams.b);
    std::size_t pairs = 0;
    for (const Crossing& known : all_crossings(pair)) {
        std::array<PlacedFace, 2> faces;
        faces[known.side].set(pair, known.side, known.edge / 3);
        faces[1 - known.side].set(pair, 1 - known.side, known.face);
        Crossing other, back;
        ASSERT_TRUE(find_other(pair, faces, known, other));
        ASSERT_TRUE(find_other(pair, faces, other, back));
        EXPECT_TRUE(back.is_same(known));
        EXPECT_EQ(back.at, known.at) << "where an edge is crossed is one number";
        ++pairs;
    }
    EXPECT_GE(pairs, 8u);
}

TEST(Loops, BeamsThatDoNotMeetHaveNone) {
    const Beams apart(1.001), touching(1); // faces that touch are parted by the perturbation
    EXPECT_TRUE(all_crossings(PairMeshes(apart.a, apart.b)).empty());
    EXPECT_TRUE(all_crossings(PairMeshes(touching.a, touching.b)).empty());
}

} // namespace
} // namespace raycontact
