// SPDX-License-Identifier: Apache-2.0
// Queries against all triangles in double (brute_force.h): closed and open meshes, tiny and huge, far from the origin.
#include <raycontact/query.h>

#include "reference/meshes.h"
#include "reference/random.h"
#include "unit/query/brute_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;

struct Subject {
    Mesh mesh;
    std::shared_ptr<const Shape> shape;
    bool closed;
};

Subject subject(Mesh mesh) {
    auto shape = Shape::make(mesh);
    const bool closed = shape->has_inside();
    return {std::move(mesh), std::move(shape), closed};
}

/// Coordinates that float32 cannot hold.
Mesh shaken(Mesh mesh, Random& random) {
    for (Vec3& v : mesh.vertices)
        v = {v.x + 1e-3 * random.uniform(), v.y + 1e-3 * random.uniform(), v.z + 1e-3 * random.uniform()};
    return mesh;
}

Mesh scaled(Mesh mesh, double by) {
    for (Vec3& v : mesh.vertices) v = {v.x * by, v.y * by, v.z * by};
    return mesh;
}

Mesh sliver_mesh() { // a tetrahedron ten thousand times longer than wide
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 1e-4, 0}, {1, 0, 1e-4}, {1.3, -1e-4, -1e-4}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    return mesh;
}

/// Of a few to some twenty triangles.
std::vector<Subject> small_subjects(double scale, const Vec3& off) {
    Random random(5);
    std::vector<Subject> subjects;
    for (const Mesh& mesh : {box_mesh({0.7, 0.35, 1.1}), tetrahedron_mesh(), shaken(cone_mesh(), random),
                             shaken(l_prism_mesh(), random), frame_mesh(), shaken(bumpy_octahedron_mesh(2), random),
                             open_box_mesh(1), shaken(sheet_mesh(2), random), sliver_mesh()})
        subjects.push_back(subject(moved(scaled(mesh, scale), off)));
    return subjects;
}

const Subject& any_of(const std::vector<Subject>& subjects, Random& random) {
    return subjects[random.below(static_cast<std::uint32_t>(subjects.size()))];
}

Vec3 sum(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double apart(const Vec3& a, const Vec3& b) {
    return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// A pose that brings the middle of a shape to a place.
Pose pose_at(const Shape& shape, const Vec3& place, Random& random) {
    Pose pose = random.rotation();
    pose.translation = sum(place, -1, transform_point(pose, shape.centre()));
    return pose;
}

/// Sizes and places: plain, tiny, huge, and far from the origin of the file.
struct World {
    double scale;
    Vec3 off;
    double precision; ///< of distances, in sizes
};
constexpr std::array worlds{World{1, {}, 1e-12}, World{1e-5, {}, 1e-12}, World{1e6, {}, 1e-12},
                            World{1, {5e5, -3e5, 1e6}, 1e-8}};

void compare_distances(const World& world, int count, std::uint64_t seed) {
    const std::vector<Subject> subjects = small_subjects(world.scale, world.off);
    Random random(seed);
    int meeting = 0, apart_count = 0;
    for (int i = 0; i < count; ++i) {
        const Subject &a = any_of(subjects, random), &b = any_of(subjects, random);
        const double spread = (i % 4 == 0 ? 6 : 1.5) * world.scale;
        const Pose pose_a = pose_at(*a.shape, sum({}, spread, random.in_ball()), random);
        const Pose pose_b = pose_at(*b.shape, sum({}, spread, random.in_ball()), random);
        const auto triangles_a = brute::placed(a.mesh, pose_a), triangles_b = brute::placed(b.mesh, pose_b);
        const double expected = brute::distance(triangles_a, a.closed, triangles_b, b.closed);
        const double size = brute::size_of(triangles_a) + brute::size_of(triangles_b);
        const auto found = distance(*a.shape, pose_a, *b.shape, pose_b);
        ASSERT_TRUE(found);
        // The reference looks for a minimum by its value, so it knows places to some 1e-8 of the size.
        ASSERT_NEAR(found->distance, expected, 1e-7 * size) << i;
        ASSERT_EQ(found->distance == 0, intersects(*a.shape, pose_a, *b.shape, pose_b)) << i;
        ASSERT_NEAR(apart(found->point_a, found->point_b), found->distance, world.precision * size) << i;
        (expected == 0 ? meeting : apart_count)++;
        for (const auto& [triangle, point, triangles] : {std::tuple(found->triangle_a, found->point_a, &triangles_a),
                                                         std::tuple(found->triangle_b, found->point_b, &triangles_b)}) {
            if (found->distance > 0) {
                ASSERT_NE(triangle, Shape::no_triangle);
            }
            if (triangle == Shape::no_triangle) continue;
            // Where they meet, the point is where the two planes do, to rounding.
            ASSERT_LE(brute::distance(point, (*triangles)[triangle]), (found->distance > 0 ? 1e-9 : 1e-6) * size) << i;
        }
        if (found->distance == 0) continue;
        ASSERT_FALSE(distance(*a.shape, pose_a, *b.shape, pose_b, 0.999 * found->distance)) << i;
        const auto within = distance(*a.shape, pose_a, *b.shape, pose_b, 1.001 * found->distance);
        ASSERT_TRUE(within) << i;
        ASSERT_NEAR(within->distance, found->distance, world.precision * size) << i;
        const auto back = distance(*b.shape, pose_b, *a.shape, pose_a);
        ASSERT_TRUE(back) << i;
        ASSERT_NEAR(back->distance, found->distance, 10 * world.precision * size) << i;
    }
    EXPECT_GT(meeting, count / 20);
    EXPECT_GT(apart_count, count / 4);
}

TEST(RandomQueries, DistanceIsTheLeast) {
    compare_distances(worlds[0], 14000, 1);
}
TEST(RandomQueries, DistanceOfTinyMeshes) {
    compare_distances(worlds[1], 2000, 2);
}
TEST(RandomQueries, DistanceOfHugeMeshes) {
    compare_distances(worlds[2], 2000, 3);
}
TEST(RandomQueries, DistanceFarFromTheOrigin) {
    compare_distances(worlds[3], 2000, 4);
}

TEST(RandomQueries, DistanceOfFinerMeshes) {
    Random random(17);
    std::vector<Subject> subjects;
    for (const Mesh& mesh : {bumpy_octahedron_mesh(8), grid_box_mesh(7), sheet_mesh(16), bowl_mesh(14)})
        subjects.push_back(subject(shaken(mesh, random)));
    for (int i = 0; i < 60; ++i) {
        const Subject &a = any_of(subjects, random), &b = any_of(subjects, random);
        const Pose pose_a = pose_at(*a.shape, {}, random),
                   pose_b = pose_at(*b.shape, sum({}, 3, random.in_ball()), random);
        const auto triangles_a = brute::placed(a.mesh, pose_a), triangles_b = brute::placed(b.mesh, pose_b);
        const double expected = brute::distance(triangles_a, a.closed, triangles_b, b.closed);
        const auto found = distance(*a.shape, pose_a, *b.shape, pose_b);
        ASSERT_TRUE(found);
        ASSERT_NEAR(found->distance, expected, 1e-7) << i;
    }
}

TEST(RandomQueries, ClosestPointIsTheClosest) {
    for (const World& world : worlds) {
        const std::vector<Subject> subjects = small_subjects(world.scale, world.off);
        Random random(23);
        for (int i = 0; i < 3000; ++i) {
            const Subject& s = any_of(subjects, random);
            const Pose pose = pose_at(*s.shape, sum({}, world.scale, random.in_ball()), random);
            const Vec3 point = sum({}, (i % 3 == 0 ? 30 : 2) * world.scale, random.in_ball());
            const auto triangles = brute::placed(s.mesh, pose);
            const double expected = brute::distance(point, triangles), size = 30 * world.scale;
            const auto found = closest_point(*s.shape, pose, point);
            ASSERT_TRUE(found);
            ASSERT_NEAR(found->distance, expected, world.precision * size) << i;
            ASSERT_NEAR(apart(found->point, point), expected, world.precision * size) << i;
            ASSERT_LE(brute::distance(found->point, triangles[found->triangle]), world.precision * size) << i;
            ASSERT_FALSE(closest_point(*s.shape, pose, point, 0.999 * expected)) << i;
            ASSERT_TRUE(closest_point(*s.shape, pose, point, found->distance)) << i;
        }
    }
}

TEST(RandomQueries, RaysMeetWhatTheyShould) {
    for (const World& world : worlds) {
        const std::vector<Subject> subjects = small_subjects(world.scale, world.off);
        Random random(29);
        int hits = 0, differing = 0;
        constexpr int count = 5000;
        for (int i = 0; i < count; ++i) {
            const Subject& s = any_of(subjects, random);
            const Pose pose = pose_at(*s.shape, sum({}, world.scale, random.in_ball()), random);
            const Vec3 origin = sum({}, (i % 3 == 0 ? 100 : 2) * world.scale, random.in_ball());
            Vec3 direction = sum(sum({}, 1.5 * world.scale, random.in_ball()), -1, origin);
            const double length = std::hypot(direction.x, direction.y, direction.z);
            direction = {direction.x / length, direction.y / length, direction.z / length};
            const auto triangles = brute::placed(s.mesh, pose);
            const auto expected = brute::raycast(triangles, origin, direction);
            const double stretch = std::pow(10, random.uniform(-30, 30)); // of no account
            const auto found = raycast(*s.shape, pose, origin, sum({}, stretch, direction));
            ASSERT_EQ(raycast_any(*s.shape, pose, origin, direction), found.has_value()) << i;
            if (found.has_value() != expected.has_value()
                || (found && std::fabs(found->distance - expected->distance) > 100 * world.precision * world.scale)) {
                ++differing; // at an edge, seen edge-on or rounded differently
                continue;
            }
            if (!found) continue;
            ++hits;
            ASSERT_LE(apart(found->point, sum(origin, found->distance, direction)), 1e-9 * world.scale) << i;
            ASSERT_LE(brute::distance(found->point, triangles[found->triangle]), 100 * world.precision * world.scale)
                << i;
            const double facing =
                found->normal.x * direction.x + found->normal.y * direction.y + found->normal.z * direction.z;
            if (s.closed && !contains(*s.shape, pose, origin)) {
                ASSERT_LE(facing, 0) << "from outside the first face met looks back";
            }
            ASSERT_NEAR(std::hypot(found->normal.x, found->normal.y, found->normal.z), 1, 1e-12);
            ASSERT_FALSE(raycast(*s.shape, pose, origin, direction, 0.999 * found->distance)) << i;
            ASSERT_TRUE(raycast_any(*s.shape, pose, origin, direction, 1.001 * found->distance)) << i;
        }
        EXPECT_GT(hits, count / 5);
        EXPECT_LE(differing, 5) << world.scale;
    }
}

TEST(RandomQueries, PointsAreInsideWhereTheWindingSaysSo) {
    for (const World& world : worlds) {
        const std::vector<Subject> subjects = small_subjects(world.scale, world.off);
        Random random(31);
        int inside = 0;
        for (int i = 0; i < 4000; ++i) {
            const Subject& s = any_of(subjects, random);
            const Pose pose = pose_at(*s.shape, {}, random);
            const Vec3 point = sum({}, world.scale, random.in_ball());
            const auto triangles = brute::placed(s.mesh, pose);
            const double winding = brute::winding(triangles, point);
            const bool expected = s.closed && std::fabs(winding) > 0.5;
            if (brute::distance(point, triangles) < 100 * world.precision * world.scale) continue;
            ASSERT_EQ(contains(*s.shape, pose, point), expected) << i << " " << winding;
            inside += expected;
        }
        EXPECT_GT(inside, 300);
    }
}

} // namespace
} // namespace raycontact
