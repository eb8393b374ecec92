// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/solids.h"

#include "mesh/predicates.h"
#include "mesh/self_intersection.h"

#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <algorithm>

using namespace raycontact;
using namespace raycontact::test;

namespace {

/// Every order of the corners of both, and both ways round, must give the same answer.
bool meet(const std::vector<Vec3>& points, Triangle a, Triangle b) {
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    const bool first = triangles_meet(points, a, b);
    do {
        do {
            EXPECT_EQ(triangles_meet(points, a, b), first);
            EXPECT_EQ(triangles_meet(points, b, a), first);
        } while (std::next_permutation(b.begin(), b.end()));
    } while (std::next_permutation(a.begin(), a.end()));
    return first;
}

TEST(Predicates, SignsBelowTheRoundingOfDouble) {
    // c lies on the line through a and b up to one unit in the last place.
    const Vec3 a{0.5, 0.5, 0}, b{12, 12, 0};
    const double above = std::nextafter(24.0, 25.0);
    EXPECT_EQ(orient2d(a, b, {24, 24, 0}, 2), 0);
    EXPECT_EQ(orient2d(a, b, {24, above, 0}, 2), 1);
    EXPECT_EQ(orient2d(a, b, {above, 24, 0}, 2), -1);
    const Vec3 c{24, 3, 1}, d = {7, 9.1, 0.3};
    const Vec3 on{0.25 * (a.x + b.x + c.x + d.x), 0, 0};
    EXPECT_EQ(orient3d(a, b, c, d), -orient3d(b, a, c, d));
    EXPECT_NE(orient3d(a, b, c, on), 0);
    const Vec3 p{0.1, 0.1, 0.1}, q{0.2, 0.2, 0.2}, r{0.3, 0.7, 0.5};
    EXPECT_EQ(orient3d(p, q, r, {0.4, 0.4, 0.4}), 0);
    EXPECT_EQ(orient3d(p, q, r, {0.4, 0.4, std::nextafter(0.4, 1.0)}),
              -orient3d(p, q, r, {0.4, 0.4, std::nextafter(0.4, 0.0)}));
    EXPECT_NE(orient3d(p, q, r, {0.4, 0.4, std::nextafter(0.4, 1.0)}), 0);
    EXPECT_TRUE(collinear(p, q, {0.4, 0.4, 0.4}));
    EXPECT_FALSE(collinear(p, q, {0.4, 0.4, std::nextafter(0.4, 1.0)}));
}

TEST(SelfIntersection, TrianglesApart) {
    const std::vector<Vec3> p{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {5, 5, 1}, {1, 1, 0}, {2, 1, 0},
                              {1, 2, 0}, {4, 4, 0}, {5, 4, 0}, {4, 5, 0},  {2, 2, 0}, {3, 3, 1}, {3, 3, -1}};
    EXPECT_TRUE(meet(p, {0, 1, 2}, {3, 4, 5}));    // through it
    EXPECT_TRUE(meet(p, {0, 1, 2}, {6, 7, 8}));    // in it, coplanar
    EXPECT_FALSE(meet(p, {0, 1, 2}, {9, 10, 11})); // beside it, coplanar
    EXPECT_TRUE(meet(p, {0, 1, 2}, {12, 13, 14})); // a corner touches an edge
    EXPECT_TRUE(meet(p, {0, 1, 2}, {6, 4, 13}));   // a corner touches the face
    EXPECT_FALSE(meet(p, {0, 1, 2}, {4, 5, 13}));  // above it
}

TEST(SelfIntersection, OneSharedVertex) {
    const std::vector<Vec3> p{{0, 0, 0},  {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, -1}, {-1, 0, 0},
                              {0, -1, 0}, {1, 1, 0}, {2, 1, 0}, {8, 0, 0}, {9, 0, 1}};
    EXPECT_TRUE(meet(p, {0, 1, 2}, {0, 3, 4}));  // cuts through
    EXPECT_FALSE(meet(p, {0, 1, 2}, {0, 5, 6})); // fans out, coplanar
    EXPECT_FALSE(meet(p, {0, 1, 2}, {0, 5, 3}));
    EXPECT_TRUE(meet(p, {0, 1, 2}, {0, 7, 8}));  // lies in it
    EXPECT_TRUE(meet(p, {0, 1, 2}, {0, 9, 10})); // along an edge
}

TEST(SelfIntersection, SharedEdgeOrAllThreeVertices) {
    const std::vector<Vec3> p{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, 0}, {1, -1, 0}, {1, 1, 1e-9}, {1, 1, 0}};
    EXPECT_FALSE(meet(p, {0, 1, 2}, {0, 1, 4})); // flat, unfolded
    EXPECT_TRUE(meet(p, {0, 1, 2}, {0, 1, 3}));  // folded flat
    EXPECT_TRUE(meet(p, {0, 1, 2}, {0, 1, 6}));
    EXPECT_FALSE(meet(p, {0, 1, 2}, {0, 1, 5})); // nearly folded
    EXPECT_TRUE(meet(p, {0, 1, 2}, {2, 1, 0}));
}

TEST(SelfIntersection, WholeMeshes) {
    EXPECT_FALSE(prepare_mesh(torus(40, 20, 1, 0.3, 0.3)).report.self_intersecting);
    const PrepareOptions leave{.overlaps = Overlaps::leave};
    EXPECT_TRUE(prepare_mesh(torus(40, 20, 1, 1.2), leave).report.self_intersecting); // a spindle
    Mesh two = torus(20, 10, 1, 0.3);
    append(two, torus(20, 10, 1, 0.3), {0.3, 0.1, 0.05});
    EXPECT_TRUE(prepare_mesh(two, leave).report.self_intersecting);
    Mesh apart = torus(20, 10, 1, 0.3);
    append(apart, torus(20, 10, 1, 0.3), {0, 0, 0.7});
    EXPECT_FALSE(prepare_mesh(apart).report.self_intersecting);
}

} // namespace
