// SPDX-License-Identifier: Apache-2.0
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

Vec3 sum(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

Mesh odd_octahedron(std::uint32_t n, Random& random) {
    Mesh mesh = bumpy_octahedron_mesh(n);
    for (Vec3& v : mesh.vertices) v = sum(v, 1e-3, random.in_ball());
    return mesh;
}

// Rays from inside at vertices, edges and their last bits beside: none gets out of a closed mesh.
TEST(Raycast, NoRaySlipsThroughAnEdge) {
    Random random(3);
    for (const Vec3& off : {Vec3{}, Vec3{1e4, -2e4, 3e4}}) {
        const Mesh mesh = moved(odd_octahedron(6, random), off);
        const auto shape = Shape::make(mesh);
        for (int i = 0; i < 20000; ++i) {
            Pose pose = i % 2 == 0 ? Pose{} : random.rotation();
            pose.translation = sum({}, i % 3 == 0 ? 0 : 10, random.in_ball());
            const Vec3 origin = transform_point(pose, sum(off, 0.2, random.in_ball()));
            const auto& t = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
            const Vec3 a = transform_point(pose, mesh.vertices[t[0]]), b = transform_point(pose, mesh.vertices[t[1]]);
            const double part = i % 4 == 0 ? 0 : random.uniform();
            const Vec3 target = sum(a, part, sum(b, -1, a)), direction = sum(target, -1, origin);
            const auto hit = raycast(*shape, pose, origin, direction);
            ASSERT_TRUE(hit) << i;
            const double length = std::hypot(direction.x, direction.y, direction.z);
            ASSERT_LE(hit->distance, length * (1 + 1e-6)) << i;
            ASSERT_TRUE(raycast_any(*shape, pose, origin, direction, hit->distance * (1 + 1e-12))) << i;
            // From outside, towards a point inside.
            ASSERT_TRUE(raycast_any(*shape, pose, sum(origin, 50 / length, direction), sum({}, -1, direction))) << i;
        }
    }
}

TEST(Raycast, OfABox) {
    const auto box = Shape::make(box_mesh({0.35, 12.7, 0.55}));
    const auto hit = raycast(*box, {}, {-2, 0.3, 0.1}, {5, 0, 0});
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->distance, 1.65);
    EXPECT_NEAR(hit->normal.x, -1, 1e-15);
    EXPECT_DOUBLE_EQ(hit->point.x, -0.35);
    const auto within = raycast(*box, {}, {0, 0, 0}, {0, 0, -1e-300});
    ASSERT_TRUE(within);
    EXPECT_NEAR(within->distance, 0.55, 1e-15);
    EXPECT_NEAR(within->normal.z, -1, 1e-15) << "met from inside, as it is wound";
    EXPECT_TRUE(raycast(*box, {}, {-2, 0.3, 0.1}, {1e300, 0, 0}, 1.65));
    EXPECT_FALSE(raycast(*box, {}, {-2, 0.3, 0.1}, {1, 0, 0}, 1.6499));
    EXPECT_FALSE(raycast(*box, {}, {-2, 0.3, 0.1}, {-1, 0, 0}));
    // On the surface, and along it.
    for (const double way : {-1.0, 1.0}) {
        const auto on = raycast(*box, {}, {-0.35, 0.3, 0.1}, {way, 0, 0}, 0);
        ASSERT_TRUE(on);
        EXPECT_EQ(on->distance, 0);
    }
    EXPECT_TRUE(raycast(*box, {}, {-2, 12.7, 0.1}, {1, 0, 0})) << "in the plane of a face";
    EXPECT_TRUE(raycast(*box, {}, {-2, 12.7, 0.55}, {1, 0, 0})) << "along an edge";
    EXPECT_FALSE(raycast(*box, {}, {-2, std::nextafter(12.7, infinite), 0.1}, {1, 0, 0}));
    // Of the two triangles of a face, on their common edge, the lower one.
    EXPECT_EQ(raycast(*box, {}, {-2, 0, 0}, {1, 0, 0})->triangle % 2, 0u);
}

TEST(Raycast, FromFarAway) {
    const auto box = Shape::make(box_mesh({0.35, 0.7, 0.55}));
    for (const double far : {1e3, 1e6, 1e9, 1e15, 1e29}) {
        const auto hit = raycast(*box, {}, {far, 0.1, 0.2}, {-1, 0, 0});
        ASSERT_TRUE(hit) << far;
        EXPECT_NEAR(hit->distance, far - 0.35, 1e-15 * far + 1e-12);
        EXPECT_FALSE(raycast(*box, {}, {far, 0.1, 0.2}, {1, 0, 0})) << far;
        EXPECT_FALSE(raycast(*box, {}, {far, 0.701, 0.2}, {-1, 0, 0})) << far;
    }
}

TEST(Raycast, AFlatSheetSeenEdgeOnIsNotMet) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1.1, 0, 0}, {1.1, 0.7, 0}, {0, 0.7, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const auto sheet = Shape::make(mesh);
    EXPECT_FALSE(raycast(*sheet, {}, {-1, 0.3, 0}, {1, 0, 0}));
    EXPECT_TRUE(raycast(*sheet, {}, {-1, 0.3, 0.1}, {1.5, 0, -0.1}));
    EXPECT_TRUE(raycast(*sheet, {}, {0.3, 0.3, -1}, {0, 0, 1})) << "from behind";
}

TEST(Queries, RefuseBadInput) {
    const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Pose twice;
    twice.rotation[0] = 2;
    for (const Pose& pose : {twice, Pose{.translation = {nan, 0, 0}}, Pose{.translation = {0, 1e31, 0}}}) {
        EXPECT_THROW(raycast(*box, pose, {}, {1, 0, 0}), InputError);
        EXPECT_THROW(raycast_any(*box, pose, {}, {1, 0, 0}), InputError);
        EXPECT_THROW(closest_point(*box, pose, {}), InputError);
        EXPECT_THROW(contains(*box, pose, {}), InputError);
        EXPECT_THROW(distance(*box, pose, *box, {}), InputError);
        EXPECT_THROW(distance(*box, {}, *box, pose), InputError);
        EXPECT_THROW(intersects(*box, pose, *box, {}), InputError);
        EXPECT_THROW(common_point(*box, {}, *box, pose), InputError);
    }
    for (const Vec3& point : {Vec3{nan, 0, 0}, Vec3{0, infinite, 0}, Vec3{0, 0, 1e31}}) {
        EXPECT_THROW(raycast(*box, {}, point, {1, 0, 0}), InputError);
        EXPECT_THROW(closest_point(*box, {}, point), InputError);
        EXPECT_THROW(contains(*box, point), InputError);
    }
    for (const Vec3& direction : {Vec3{}, Vec3{nan, 0, 0}, Vec3{0, 0, infinite}})
        EXPECT_THROW(raycast(*box, {}, {}, direction), InputError);
    for (const double max : {-1.0, nan}) {
        EXPECT_THROW(raycast(*box, {}, {}, {1, 0, 0}, max), InputError);
        EXPECT_THROW(closest_point(*box, {}, {}, max), InputError);
        EXPECT_THROW(distance(*box, {}, *box, {}, max), InputError);
    }
    try {
        raycast(*box, {}, {}, {});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "raycast: the direction is zero; give one of any length above 0");
    }
}

TEST(Distance, OfBoxes) {
    const auto box = Shape::make(box_mesh({0.5, 0.5, 0.5})), small = Shape::make(box_mesh({0.1, 0.1, 0.1}));
    const auto beside = distance(*box, {}, *small, {.translation = {2, 0.05, 0.02}});
    ASSERT_TRUE(beside);
    EXPECT_NEAR(beside->distance, 1.4, 1e-15);
    EXPECT_NEAR(beside->point_a.x, 0.5, 1e-15);
    EXPECT_NEAR(beside->point_b.x, 1.9, 1e-15);
    EXPECT_NEAR(beside->point_a.y, beside->point_b.y, 1e-15);
    const auto corners = distance(*box, {}, *small, {.translation = {1.6, 1.6, 1.6}});
    ASSERT_TRUE(corners);
    EXPECT_NEAR(corners->distance, std::sqrt(3.0), 1e-15);
    const auto inside = distance(*box, {}, *small, {.translation = {0.1, 0, 0}});
    ASSERT_TRUE(inside);
    EXPECT_EQ(inside->distance, 0);
    EXPECT_EQ(inside->triangle_a, Shape::no_triangle);
    EXPECT_NE(inside->triangle_b, Shape::no_triangle);
    EXPECT_EQ(inside->point_a, inside->point_b);
    EXPECT_TRUE(distance(*box, {}, *small, {.translation = {0.1, 0, 0}}, 0)) << "though no surfaces are near";
    EXPECT_TRUE(distance(*box, {}, *small, {.translation = {0.6, 0, 0}}, 0)) << "touching";
    EXPECT_FALSE(distance(*box, {}, *small, {.translation = {0.61, 0, 0}}, 0));
    EXPECT_FALSE(distance(*box, {}, *small, {.translation = {1e25, 0, 0}}, 1e24));
    EXPECT_NEAR(distance(*box, {}, *small, {.translation = {1e25, 0, 0}})->distance, 1e25, 1e10);
}

} // namespace
} // namespace raycontact
