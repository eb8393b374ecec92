// SPDX-License-Identifier: Apache-2.0
// Cases by hand; tests/exact asks thousands of random pairs and compares with CGAL.
#include <raycontact/collide.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

Pose at(double x, double y, double z) {
    return {.translation = {x, y, z}};
}

Mesh turned_inside_out(Mesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

void append(Mesh& mesh, const Mesh& more) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
    for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({a + base, b + base, c + base});
}

bool both_ways(const Shape& a, const Shape& b, const Pose& pose_b) {
    const bool answer = intersects(a, {}, b, pose_b);
    EXPECT_EQ(answer, intersects(b, pose_b, a, {}));
    return answer;
}

TEST(Intersects, BoxesThatTouchDo) {
    const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    EXPECT_TRUE(both_ways(*box, *box, at(0.5, 0.25, 0.125)));
    EXPECT_TRUE(both_ways(*box, *box, at(1, 0, 0))) << "faces";
    EXPECT_TRUE(both_ways(*box, *box, at(1, 1, 0))) << "edges";
    EXPECT_TRUE(both_ways(*box, *box, at(1, 1, 1))) << "corners";
    EXPECT_TRUE(both_ways(*box, *box, at(0, 0, 0))) << "a box and itself";
    EXPECT_FALSE(both_ways(*box, *box, at(1.0000001, 0, 0)));
    EXPECT_FALSE(both_ways(*box, *box, at(1 + 1e-15, 1, 1)));
}

TEST(Intersects, OneInsideTheOther) {
    const auto box = Shape::make(box_mesh({1, 1, 1})), small = Shape::make(box_mesh({0.1, 0.1, 0.1}));
    EXPECT_TRUE(both_ways(*box, *small, at(0.3, 0.2, 0.1)));
    EXPECT_FALSE(both_ways(*box, *small, at(3, 0, 0)));
}

TEST(Intersects, AHollowIsOutside) {
    Mesh mesh = box_mesh({1, 1, 1});
    append(mesh, turned_inside_out(box_mesh({0.5, 0.5, 0.5})));
    const auto hollow = Shape::make(prepare_mesh(mesh, {.repair = Repair::as_is})),
               small = Shape::make(box_mesh({0.1, 0.1, 0.1}));
    EXPECT_FALSE(both_ways(*hollow, *small, at(0.3, 0.2, 0.1)));
    EXPECT_TRUE(both_ways(*hollow, *small, at(0.7, 0.2, 0.1))) << "within the wall";
}

TEST(Intersects, AnOpenMeshHasNoInside) {
    const auto open = Shape::make(open_box_mesh(4)), sheet = Shape::make(sheet_mesh(4));
    const Vec3 middle = open->centre();
    const auto tiny = Shape::make(box_mesh({0.01, 0.01, 0.01}));
    EXPECT_FALSE(both_ways(*open, *tiny, at(middle.x, middle.y, middle.z)));
    EXPECT_TRUE(both_ways(*sheet, *sheet, Pose{.rotation = {1, 0, 0, 0, 0, -1, 0, 1, 0}})) << "two sheets that cross";
}

// A bar of each runs through the hole of the other.
TEST(Intersects, LinksOfAChainDoNot) {
    const auto link = Shape::make(frame_mesh());
    Pose linked{.rotation = {1, 0, 0, 0, 0, -1, 0, 1, 0}, .translation = {0.5625, 0, 0}};
    EXPECT_FALSE(both_ways(*link, *link, linked));
    linked.translation.x = 0.8;
    EXPECT_TRUE(both_ways(*link, *link, linked));
}

} // namespace
} // namespace raycontact
