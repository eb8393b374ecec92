// SPDX-License-Identifier: Apache-2.0
// Of convex meshes against all normals that their difference can have; of others by hand, and by ways at random.
#include <raycontact/query.h>
#include <raycontact/separation.h>

#include "reference/meshes.h"
#include "reference/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;
using ShapePtr = std::shared_ptr<const Shape>;

Vec3 sum(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
Pose at(const Vec3& place) {
    return {.translation = place};
}
Pose parted(const Pose& pose_b, const Separation& found) {
    Pose pose = pose_b;
    pose.translation = sum(pose.translation, std::max(-found.distance, 0.0), found.normal);
    return pose;
}

std::vector<Vec3> placed(const Shape& shape, const Pose& pose) {
    std::vector<Vec3> points;
    for (const Vec3& v : shape.file_vertices()) points.push_back(transform_point(pose, v));
    return points;
}

/// How far b goes along a direction until the hulls are apart.
double way_out(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Vec3& way) {
    double last = -1e300, first = 1e300;
    for (const Vec3& v : a) last = std::max(last, dot(v, way));
    for (const Vec3& v : b) first = std::min(first, dot(v, way));
    return (last - first) / std::sqrt(dot(way, way));
}

/// Of convex meshes: the boundary of their difference has faces of either, and of an edge of each.
double least_way_out(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const std::vector<Vec3> points_a = placed(a, pose_a), points_b = placed(b, pose_b);
    std::vector<Vec3> ways, edges_a, edges_b;
    const auto collect = [&](const Shape& shape, const std::vector<Vec3>& p, std::vector<Vec3>& edges) {
        for (const auto& t : shape.triangles()) {
            ways.push_back(cross(sum(p[t[1]], -1, p[t[0]]), sum(p[t[2]], -1, p[t[0]])));
            for (std::size_t k = 0; k < 3; ++k) edges.push_back(sum(p[t[(k + 1) % 3]], -1, p[t[k]]));
        }
    };
    collect(a, points_a, edges_a);
    collect(b, points_b, edges_b);
    for (const Vec3& p : edges_a)
        for (const Vec3& q : edges_b)
            if (const Vec3 way = cross(p, q); dot(way, way) > 1e-12 * dot(p, p) * dot(q, q)) ways.push_back(way);
    double least = 1e300;
    for (const Vec3& way : ways)
        least = std::min({least, way_out(points_a, points_b, way), way_out(points_b, points_a, way)});
    return least;
}

TEST(Separation, OfConvexMeshesIsTheLeastToOnePercent) {
    std::vector<ShapePtr> shapes;
    for (const Mesh& mesh : {box_mesh({0.7, 0.35, 1.1}), box_mesh({1.5, 0.02, 0.1}), tetrahedron_mesh(), cone_mesh(),
                             grid_box_mesh(3), box_mesh({1, 1e-4, 1e-4})})
        shapes.push_back(Shape::make(mesh));
    Random random(3);
    int asked = 0;
    for (int i = 0; i < 4000 && asked < 500; ++i) {
        const Shape &a = *shapes[i % 20 == 0 ? 5 : random.below(6)], &b = *shapes[i % 20 == 0 ? 5 : random.below(6)];
        const Pose pose_a = random.rotation();
        Pose pose_b = random.rotation();
        pose_b.translation = sum({}, i % 20 == 0 ? 1e-5 : random.uniform(0, 2), random.in_ball());
        if (!intersects(a, pose_a, b, pose_b)) continue;
        ++asked;
        const Separation found = separation(a, pose_a, b, pose_b);
        const double least = least_way_out(a, pose_a, b, pose_b);
        ASSERT_GE(-found.distance, least - 1e-9) << asked;
        ASSERT_LE(-found.distance, 1.01 * least + 1e-5) << asked;
        ASSERT_NEAR(dot(found.normal, found.normal), 1, 1e-12);
        ASSERT_FALSE(intersects(a, pose_a, b, parted(pose_b, found))) << asked;
    }
    EXPECT_GT(asked, 300);
}

TEST(Separation, OfAnyMeshesPartsThem) {
    std::vector<ShapePtr> shapes;
    for (const Mesh& mesh : {box_mesh({0.7, 0.35, 1.1}), l_prism_mesh(), frame_mesh(), bumpy_octahedron_mesh(2),
                             open_box_mesh(1), sheet_mesh(2)})
        shapes.push_back(Shape::make(mesh));
    Random random(4);
    int apart_count = 0, longer = 0, asked = 0;
    for (int i = 0; i < 200; ++i) {
        const Shape &a = *shapes[random.below(6)], &b = *shapes[random.below(6)];
        const Pose pose_a = random.rotation();
        Pose pose_b = random.rotation();
        pose_b.translation = sum({}, 2, random.in_ball());
        const Separation found = separation(a, pose_a, b, pose_b);
        const Distance outside = *distance(a, pose_a, b, pose_b);
        ASSERT_EQ(found.distance > 0, outside.distance > 0) << i;
        const Pose away = parted(pose_b, found);
        const Distance after = *distance(a, pose_a, b, away);
        ASSERT_GT(after.distance, 0) << i;
        // The points are those that are closest then, but that of b is where b is given.
        const Vec3 point_b = sum(found.point_b, std::max(-found.distance, 0.0), found.normal);
        const Vec3 between = sum(point_b, -1, found.point_a);
        ASSERT_NEAR(std::sqrt(dot(between, between)), after.distance, 1e-5) << i;
        if (outside.distance > 0) {
            ++apart_count;
            ASSERT_EQ(found.distance, outside.distance) << i;
            continue;
        }
        // No longer than by any of a hundred ways at random, but for a few.
        const auto points_a = placed(a, pose_a), points_b = placed(b, pose_b);
        double least = 1e300;
        for (int k = 0; k < 100; ++k) {
            const Vec3 way = random.direction();
            const double far = way_out(points_a, points_b, way) + 1e-5;
            Pose from = pose_b;
            from.translation = sum(from.translation, far, way);
            if (const auto met = time_of_impact(a, pose_a, pose_a, b, from, pose_b))
                least = std::min(least, far * (1 - met->time));
        }
        ++asked;
        longer += -found.distance > 1.02 * least + 1e-5;
    }
    EXPECT_GT(apart_count, 30);
    EXPECT_GT(asked, 50);
    EXPECT_LE(longer, asked / 50);
}

// A peg in a hole has a short way out that no hull knows.
TEST(Separation, OfAPegInAFrameIsByTheHole) {
    const ShapePtr frame = Shape::make(frame_mesh()), floor = Shape::make(box_mesh({3, 3, 0.5}));
    const Vec3 low = frame->box_min(), high = frame->box_max();
    // Between the bars, pressed 0.01 m into one of them.
    Vec3 inside;
    double room = 0;
    for (double x = low.x; x < high.x; x += 0.01) {
        const Vec3 place{x, 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};
        if (contains(*frame, place)) continue;
        const double free = closest_point(*frame, {}, place)->distance;
        if (free > room) room = free, inside = place;
    }
    ASSERT_GT(room, 0.1);
    const ShapePtr peg = Shape::make(box_mesh({0.5 * room, 0.5 * room, 5}));
    const Pose pressed = at(sum(inside, 0.5 * room + 0.01, {1, 0, 0}));
    ASSERT_TRUE(intersects(*frame, {}, *peg, pressed));
    const Separation found = separation(*frame, {}, *peg, pressed);
    EXPECT_NEAR(found.distance, -0.01, 1e-4);
    EXPECT_NEAR(found.normal.x, -1, 1e-6);
    // Flat on a floor: straight up.
    const Separation up = separation(*floor, {}, *frame, at({0.3, 0.2, 0.5 - low.z - 0.02}));
    EXPECT_NEAR(up.distance, -0.02, 1e-4);
    EXPECT_NEAR(up.normal.z, 1, 1e-9);
    // What touches goes next to nowhere.
    const ShapePtr box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    const Separation touching = separation(*box, {}, *box, at({1, 0.1, 0.2}));
    EXPECT_LE(touching.distance, 0);
    EXPECT_GE(touching.distance, -1e-5);
    EXPECT_NEAR(touching.normal.x, 1, 1e-6);
}

} // namespace
} // namespace raycontact
