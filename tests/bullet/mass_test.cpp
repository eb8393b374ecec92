// SPDX-License-Identifier: Apache-2.0
#include "test_world.h"

#include <raycontact/bullet/mass.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace raycontact::test {
namespace {

TEST(Mass, BoxFarFromItsOrigin) {
    Mesh mesh = box_mesh(1, 2, 3);
    for (Vec3& v : mesh.vertices) v = {v.x + 10, v.y - 20, v.z + 30};
    const auto p = bullet::mass_properties(*Shape::make(mesh));
    EXPECT_NEAR(p.volume, 6, 1e-4);
    EXPECT_NEAR(p.centre.x, 10, 1e-5);
    EXPECT_NEAR(p.centre.y, -20, 1e-5);
    EXPECT_NEAR(p.centre.z, 30, 1e-5);
    EXPECT_NEAR(p.inertia[0], 6.0 / 12 * (4 + 9), 1e-3);
    EXPECT_NEAR(p.inertia[4], 6.0 / 12 * (1 + 9), 1e-3);
    EXPECT_NEAR(p.inertia[8], 6.0 / 12 * (1 + 4), 1e-3);
    EXPECT_NEAR(p.inertia[1], 0, 1e-4);
}

TEST(Mass, PrincipalAxesOfATurnedBox) {
    Mesh mesh = box_mesh(1, 2, 3);
    const Pose turn = pose_from_quaternion({}, 0.9, 0.1, -0.3, 0.2);
    for (Vec3& v : mesh.vertices) v = transform_point(turn, v);
    const auto p = bullet::mass_properties(*Shape::make(mesh));
    std::array<double, 3> moments{p.principal_inertia.x, p.principal_inertia.y, p.principal_inertia.z};
    std::sort(moments.begin(), moments.end());
    EXPECT_NEAR(moments[0], 2.5, 1e-3);
    EXPECT_NEAR(moments[1], 5, 1e-3);
    EXPECT_NEAR(moments[2], 6.5, 1e-3);
    EXPECT_NO_THROW(check_pose(p.principal, "principal axes"));
    // The mesh brought into that frame has no products of inertia left.
    for (Vec3& v : mesh.vertices) v = relative_pose(p.principal, Pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, v}).translation;
    const auto q = bullet::mass_properties(*Shape::make(mesh));
    for (const int k : {1, 2, 5}) EXPECT_NEAR(q.inertia[static_cast<std::size_t>(k)], 0, 1e-5);
}

TEST(Mass, OpenSheetIsTakenForItsBox) {
    Mesh mesh;
    mesh.name = "sheet";
    mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0.5}, {0, 2, 0.5}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const auto p = bullet::mass_properties(*Shape::make(mesh));
    EXPECT_NEAR(p.volume, 2, 1e-6);
    EXPECT_NEAR(p.centre.z, 0.25, 1e-6);
}

TEST(Mass, LocalInertiaIsThatOfTheVolume) {
    bullet::MeshShape shape(Shape::make(box_mesh(1, 2, 3)));
    btBoxShape box(btVector3(btScalar(0.5), 1, btScalar(1.5)));
    btVector3 ours, bullets;
    shape.calculateLocalInertia(7, ours);
    box.calculateLocalInertia(7, bullets);
    EXPECT_LT((ours - bullets).length(), btScalar(1e-3));
}

} // namespace
} // namespace raycontact::test
