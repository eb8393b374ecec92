// SPDX-License-Identifier: Apache-2.0
#include "test_world.h"

#include <objects.h>
#include <plane.h>
#include <scenes/random.h>

#include <gtest/gtest.h>

#include <cmath>

namespace raycontact::test {
namespace {

/// The tree may rule out boxes, never a vertex: against every vertex, one by one.
TEST(Plane, FindsEveryVertexBelowOrNear) {
    const bullet::Converted mesh{torus(), std::make_shared<bullet::BulletMesh>(torus())};
    scenes::Random random(3);
    std::size_t total = 0;
    for (int i = 0; i < 500; ++i) {
        const auto number = [&] { return btScalar(random.symmetric()); };
        btTransform pose(btQuaternion(number(), number(), number(), number()).normalized(),
                         btVector3(number(), number(), number()));
        btTransform plane_pose(btQuaternion(number(), number(), number(), number()).normalized(),
                               btVector3(number(), number(), number()));
        const btStaticPlaneShape plane(btVector3(number(), number(), number()).normalized(), number() / 2);
        const bullet::HalfSpace space = bullet::half_space(plane, plane_pose);
        const btVector3& normal = space.normal;
        std::vector<bullet::PlaneContact> found;
        const btScalar reach = i % 2 == 0 ? 0 : btScalar(0.1);
        bullet::plane_contacts(mesh, pose, space, reach, found);
        total += found.size();

        std::size_t next = 0;
        const Pose exact = bullet::to_pose(pose);
        for (std::uint32_t v = 0; v < mesh.shape->vertices().size(); ++v) {
            const Vec3 p = transform_point(exact, mesh.shape->vertices()[v]);
            const btVector3 d = plane_pose.getOrigin();
            const double height = (p.x - double(d.x())) * double(normal.x())
                                  + (p.y - double(d.y())) * double(normal.y())
                                  + (p.z - double(d.z())) * double(normal.z()) - double(plane.getPlaneConstant());
            const bool reported = next < found.size() && found[next].vertex == v;
            const double above = height - double(reach);
            if (std::fabs(above) > 1e-6) {
                ASSERT_EQ(reported, above < 0) << "pose " << i << ", vertex " << v << ", height " << height;
            }
            if (reported) {
                EXPECT_NEAR(double(found[next++].depth), -height, 1e-6);
            }
        }
        EXPECT_EQ(next, found.size());
    }
    EXPECT_GT(total, 20000u);
}

} // namespace
} // namespace raycontact::test
