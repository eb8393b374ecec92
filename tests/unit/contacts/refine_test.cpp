// SPDX-License-Identifier: Apache-2.0
// Direction `refined` where the face that a ray meets is not the exit. agreement_test holds it against brute force.
#include "reference/meshes.h"
#include "reference/random.h"
#include "reference/vector.h"

#include <raycontact/collide.h>

#include <gtest/gtest.h>

#include <cmath>

namespace raycontact {
namespace {

using namespace reference;

std::vector<Contact> vertices_of(const Mesh& a, const Pose& pose, const Mesh& b, Direction direction) {
    return collide(*Shape::make(a), pose, *Shape::make(b), {},
                   {.direction = direction, .features = Features::vertices});
}

// A roof whose ridge runs along y: the two slopes meet at z = 1.
Mesh roof() {
    Mesh mesh;
    mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, -1, 1}, {-1, 1, 0}, {1, 1, 0}, {0, 1, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 4, 1}, {0, 3, 4}, {1, 4, 5}, {1, 5, 2}, {0, 2, 5}, {0, 5, 3}};
    return mesh;
}

// A needle that stands on its tip; its axis, and so the ray of its tip, points along `axis`.
Mesh needle(const Vec3& tip, const Vec3& axis) {
    const Vec3 side{0, 1, 0}, other = cross(axis, side);
    Mesh mesh;
    mesh.vertices = {tip};
    for (const auto& [along, across] : {std::pair(0.3, 0.0), std::pair(-0.15, 0.26), std::pair(-0.15, -0.26)})
        mesh.vertices.push_back(tip + axis + along * side + across * other);
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
    return mesh;
}

// The tip is 0.035 m below the left slope, which its ray nearly follows, and 0.106 m below the right one, which it
// meets.
TEST(Refined, LeavesByTheNearerSlopeOfARidge) {
    const Vec3 tip{-0.05, 0, 0.9}, axis = unit(Vec3{0.633, 0, 0.774});
    const Vec3 left = unit(Vec3{-1, 0, 1}), right = unit(Vec3{1, 0, 1});
    const auto reprojected = vertices_of(needle(tip, axis), {}, roof(), Direction::reprojected);
    const auto refined = vertices_of(needle(tip, axis), {}, roof(), Direction::refined);
    ASSERT_EQ(reprojected.size(), 1u);
    ASSERT_EQ(refined.size(), 1u);
    EXPECT_NEAR(reprojected[0].depth, dot(right, Vec3{0, 0, 1} - tip), 1e-6);
    EXPECT_NEAR(refined[0].depth, dot(left, Vec3{0, 0, 1} - tip), 1e-6);
    EXPECT_NEAR(refined[0].normal.x, -left.x, 1e-6); // from the needle to the roof
    EXPECT_NEAR(refined[0].normal.z, -left.z, 1e-6);
    EXPECT_GE(refined[0].feature.other_index(), 6u); // of the left slope
    EXPECT_EQ(refined[0].ray_length, reprojected[0].ray_length);
}

// A corner is 1 mm below the top of the other cube, and 0.2 mm from its sides: by these it must not leave, nor where
// the cube is turned by a degree or two.
TEST(Refined, ACubeOnACubeLeavesUpwards) {
    const Mesh cube = box_mesh({0.5, 0.5, 0.5});
    for (const double askew : {0.0, 1e-4, 1e-3, 0.01, 0.03})
        for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
            Pose pose = small_rotation(axis, askew);
            pose.translation = Vec3{-0.4998, -0.4998, 0.499} - transform_point(pose, {-0.5, -0.5, -0.5});
            const auto contacts = vertices_of(cube, pose, cube, Direction::refined);
            ASSERT_FALSE(contacts.empty());
            for (const Contact& contact : contacts) {
                EXPECT_NEAR(contact.normal.z, -1, 1e-6);
                EXPECT_NEAR(contact.depth, 0.001, 1e-6);
            }
        }
}

// The foot of a peg in a hole, a little into its wall: its faces look down, so the wall does not look against them, but
// a ray met the wall, however that is divided, far above.
TEST(Refined, AWallThatARayMetCountsAsAWhole) {
    for (const int cells : {1, 8, 64}) {
        Mesh wall; // the plane x = 0 of a block, in strips along z, with a lid far up
        for (int i = 0; i <= cells; ++i)
            for (const double y : {-1.0, 1.0})
                for (const double x : {0.0, 1.0}) wall.vertices.push_back({x, y, 2.0 * i / cells - 1});
        const auto at = [](int i, int y, int x) { return static_cast<std::uint32_t>(4 * i + 2 * y + x); };
        const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
            wall.triangles.push_back({a, b, c});
            wall.triangles.push_back({a, c, d});
        };
        for (int i = 0; i < cells; ++i) {
            quad(at(i, 0, 0), at(i + 1, 0, 0), at(i + 1, 1, 0), at(i, 1, 0));
            quad(at(i, 0, 1), at(i, 1, 1), at(i + 1, 1, 1), at(i + 1, 0, 1));
            quad(at(i, 0, 0), at(i, 0, 1), at(i + 1, 0, 1), at(i + 1, 0, 0));
            quad(at(i, 1, 0), at(i + 1, 1, 0), at(i + 1, 1, 1), at(i, 1, 1));
        }
        quad(at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1));
        quad(at(cells, 0, 0), at(cells, 0, 1), at(cells, 1, 1), at(cells, 1, 0));
        ASSERT_TRUE(verdict_of(prepare_mesh(wall).report).good);
        // The middle of the foot, flat all round, is 0.01 in the wall; the peg leans by 0.03 away from it.
        const double lean = 0.03;
        Mesh peg;
        peg.vertices = {{0, 0, 0}, {0.3, 0.3, 0}, {-0.3, 0.3, 0}, {-0.3, -0.3, 0}, {0.3, -0.3, 0}, {0, 0, 0.9}};
        peg.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}, {5, 1, 2}, {5, 2, 3}, {5, 3, 4}, {5, 4, 1}};
        Pose pose;
        pose.rotation = {std::cos(lean), 0, -std::sin(lean), 0, 1, 0, std::sin(lean), 0, std::cos(lean)};
        pose.translation = {0.01, 0.05, -0.5};
        bool found = false;
        for (const Contact& contact : vertices_of(peg, pose, wall, Direction::refined)) {
            if (contact.feature.source != Side::a || contact.feature.source_index() != 0) continue;
            found = true;
            EXPECT_NEAR(contact.depth, 0.01, 1e-6) << cells;
            EXPECT_NEAR(contact.normal.x, 1, 1e-6) << cells;
        }
        EXPECT_TRUE(found) << cells;
    }
}

} // namespace
} // namespace raycontact
