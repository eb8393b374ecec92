// SPDX-License-Identifier: Apache-2.0
// Rays, closest points and points that two meshes share, against rational numbers.
#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "exact/rational_mesh.h"
#include "query/checks.h"
#include "reference/meshes.h"

#include <raycontact/query.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace raycontact::exact {
namespace {

using reference::Random;

Vec3 sum(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/// A mesh as the library has it, and in rational numbers.
struct Subject {
    std::shared_ptr<const Shape> shape;
    RationalMesh exact;
    explicit Subject(const Mesh& mesh) : shape(Shape::make(mesh)), exact(*shape) {}

    std::array<Vec3, 3> triangle(Random& random) const {
        const auto& t = shape->triangles()[random.below(static_cast<std::uint32_t>(shape->triangles().size()))];
        const auto vertices = shape->file_vertices();
        return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    }
};

/// Corners on quarters, so that sums are exact.
Mesh in_quarters(Mesh mesh) {
    for (Vec3& v : mesh.vertices) v = {std::round(4 * v.x) / 4, std::round(4 * v.y) / 4, std::round(4 * v.z) / 4};
    return mesh;
}

/// Ten times as long as wide, or more.
Mesh needles() {
    Mesh mesh = prism_solid(90, 0.5, 20);
    mesh.name = "needles";
    return mesh;
}

struct Asked {
    int rays = 0, hits = 0, ties = 0;
};

void ask(const Subject& subject, const Vec3& origin, const Vec3& direction, Asked& asked) {
    ++asked.rays;
    const auto found = raycast(*subject.shape, {}, origin, direction);
    const auto exact = subject.exact.raycast(origin, checked_direction(direction));
    ASSERT_EQ(found.has_value(), exact.has_value()) << subject.shape->name();
    EXPECT_EQ(raycast_any(*subject.shape, {}, origin, direction), exact.has_value());
    if (!exact) return;
    ++asked.hits;
    asked.ties += exact->ties > 1;
    ASSERT_EQ(found->triangle, exact->triangle) << subject.shape->name() << " " << exact->ties;
    ASSERT_NEAR(found->distance, exact->distance, 1e-12 * (1 + exact->distance)) << subject.shape->name();
    ASSERT_LT(subject.exact.closest(found->point).distance, 1e-11) << subject.shape->name();
}

// From outside, along an edge: the two faces there are nearly parallel to the ray.
TEST(ExactQueries, RaysAlongEdgesHitTheMesh) {
    Random random(31);
    Asked asked;
    std::vector<Mesh> meshes{reference::cone_mesh(), reference::l_prism_mesh(), needles()};
    for (std::uint32_t n = 3; n < 24; ++n) meshes.push_back(cone_solid(n, 1, 2));
    for (int i = 0; i < 300; ++i) meshes.push_back(reference::crooked_pyramid_mesh(random));
    for (const Mesh& mesh : meshes) {
        const Subject subject(mesh);
        for (int i = 0; i < 24; ++i) {
            const auto t = subject.triangle(random);
            const Vec3 along = sum(t[1], -1, t[0]);
            ASSERT_NO_FATAL_FAILURE(ask(subject, sum(t[0], -double(1 + i % 3), along), along, asked));
        }
    }
    EXPECT_GT(asked.hits, 2000);
    RecordProperty("rays", asked.rays);
}

// Through corners and edges, along lines that doubles hold exactly: several triangles are hit at once.
TEST(ExactQueries, OfTrianglesHitAtOnceTheLowestCounts) {
    Random random(32);
    Asked asked;
    const std::vector<Mesh> meshes{
        reference::grid_box_mesh(4), reference::grid_box_mesh(2), in_quarters(reference::l_prism_mesh()),
        in_quarters(reference::frame_mesh()),
        extruded("gear", {{0, 0}, {2, 0}, {2, 1}, {1.5, 0.5}, {1, 1}, {0.5, 0.5}, {0, 1}}, {}, 0, 1)};
    for (const Mesh& mesh : meshes) {
        const Subject subject(mesh);
        for (int i = 0; i < 1500; ++i) {
            const auto step = [&](std::uint32_t count) { return double(random.below(count)) - (count - 1) / 2.0; };
            Vec3 way{step(3), step(3), step(3)};
            if (way == Vec3{}) way.x = 1;
            const auto t = subject.triangle(random);
            const Vec3 at = i % 2 == 0 ? t[0] : sum(t[0], 0.25 * random.below(5), sum(t[1], -1, t[0]));
            ASSERT_NO_FATAL_FAILURE(ask(subject, sum(at, -double(random.below(5)), way), way, asked));
        }
    }
    EXPECT_GT(asked.ties, 2000);
}

TEST(ExactQueries, RaysAtAnythingHitTheFirstTriangle) {
    Random random(33);
    Asked asked;
    for (int m = 0; m < 60; ++m) {
        const Subject subject(coarse_solid(random));
        const double size = subject.shape->radius();
        for (int i = 0; i < 40; ++i) {
            const auto t = subject.triangle(random);
            const Vec3 at = i % 3 == 0 ? t[0] : sum(t[0], random.uniform(), sum(t[1], -1, t[0]));
            const Vec3 origin = sum(at, (i % 4 == 0 ? 100 : 3) * size, random.in_ball());
            ASSERT_NO_FATAL_FAILURE(ask(subject, origin, sum(at, -1, origin), asked));
        }
    }
    EXPECT_GT(asked.hits, 1000);
}

TEST(ExactQueries, OfTrianglesAsCloseTheLowestCounts) {
    Random random(34);
    int ties = 0, all = 0;
    std::vector<Mesh> meshes{reference::grid_box_mesh(4), in_quarters(reference::l_prism_mesh()),
                             reference::cone_mesh(), in_quarters(reference::frame_mesh()), needles()};
    for (int m = 0; m < 40; ++m) meshes.push_back(coarse_solid(random));
    for (const Mesh& mesh : meshes) {
        const Subject subject(mesh);
        const double size = subject.shape->radius();
        for (int i = 0; i < 150; ++i) {
            const auto t = subject.triangle(random);
            Vec3 point = i % 3 == 0 ? t[0] : sum(t[0], 0.25 * random.below(5), sum(t[1], -1, t[0]));
            if (i % 5 < 3) point = sum(point, i % 5 == 0 ? size : 1e-3 * size, random.in_ball());
            if (i % 5 == 3) point = {point.x + 0.25 * random.below(5), point.y - 0.25 * random.below(5), point.z};
            const auto found = closest_point(*subject.shape, {}, point);
            const auto exact = subject.exact.closest(point);
            ASSERT_TRUE(found);
            ++all;
            ties += exact.ties > 1;
            ASSERT_EQ(found->triangle, exact.triangle) << mesh.name << " " << i << " " << exact.ties;
            ASSERT_NEAR(found->distance, exact.distance, 1e-14 * size + 1e-15 * exact.distance) << mesh.name;
            ASSERT_LT(subject.exact.closest(found->point).distance, 1e-14 * size) << mesh.name;
        }
    }
    EXPECT_GT(all, 6000);
    EXPECT_GT(ties, 3000);
}

/// Whether a point lies in a placed mesh, to 1e-12 of its size.
bool has(const Shape& shape, const Pose& pose, const RationalMesh& exact, const Vec3& point) {
    return contains(shape, pose, point) || exact.closest(point).distance < 1e-12 * shape.radius();
}

/// Tells how many of these pairs share a point, which is then asked for.
int pairs_that_share(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const auto point = common_point(a, pose_a, b, pose_b);
    EXPECT_EQ(intersects(a, pose_a, b, pose_b), point.has_value());
    if (!point) return 0;
    const RationalMesh exact_a(a, pose_a), exact_b(b, pose_b);
    EXPECT_TRUE(has(a, pose_a, exact_a, *point)) << a.name() << " and " << b.name();
    EXPECT_TRUE(has(b, pose_b, exact_b, *point)) << a.name() << " and " << b.name();
    const auto witness = distance(a, pose_a, b, pose_b);
    EXPECT_TRUE(witness && witness->distance == 0);
    EXPECT_TRUE(has(a, pose_a, exact_a, witness->point_a) && has(b, pose_b, exact_b, witness->point_b));
    EXPECT_EQ(witness->point_a, witness->point_b);
    return 1;
}

Mesh triangle_mesh(const std::array<Vec3, 3>& corners) {
    Mesh mesh;
    mesh.name = "triangle";
    mesh.vertices.assign(corners.begin(), corners.end());
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TEST(ExactQueries, ASharedPointOfTwoTrianglesLiesInBoth) {
    const auto star_a = Shape::make(triangle_mesh({{{0, 0, 0}, {4, 0, 0}, {2, 3, 0}}}));
    const auto star_b = Shape::make(triangle_mesh({{{0, 2, 0}, {4, 2, 0}, {2, -1, 0}}}));
    EXPECT_EQ(pairs_that_share(*star_a, {}, *star_b, {}), 1);
    Random random(35);
    int shared = 0;
    for (int i = 0; i < 6000; ++i) {
        // In one plane on a lattice, nearly so, or anyhow.
        const auto corner = [&] {
            const Vec3 at{double(random.below(7)), double(random.below(7)), 0};
            if (i % 3 == 0) return at;
            const double off = i % 3 == 1 ? std::pow(10, random.uniform(-17, -8)) : 4;
            return sum(at, off, random.in_ball());
        };
        const std::array p{corner(), corner(), corner()}, q{corner(), corner(), corner()};
        const auto area = [](const std::array<Vec3, 3>& t) {
            return std::fabs((t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x));
        };
        if (area(p) < 0.5 || area(q) < 0.5) continue;
        Pose pose = i % 2 == 0 ? Pose{} : random.rotation();
        pose.translation = sum({}, i % 4 == 0 ? 0 : 10, random.in_ball());
        shared += pairs_that_share(*Shape::make(triangle_mesh(p)), pose, *Shape::make(triangle_mesh(q)), pose);
    }
    EXPECT_GT(shared, 2000);
}

TEST(ExactQueries, ASharedPointOfTwoPartsLiesInBoth) {
    Random random(36);
    int shared = 0;
    for (int i = 0; i < 1600; ++i) {
        const double overlap = i % 4 == 0 ? 0 : std::pow(10, random.uniform(-16, -1));
        const FlushPair pair = i % 5 < 4 ? flush_pair(static_cast<std::uint32_t>(i) % flush_kinds, overlap, random)
                                         : fitted_pair(static_cast<std::uint32_t>(i) % fitted_kinds, overlap, random);
        Pose pose = i % 3 == 0 ? Pose{} : random.rotation();
        pose.translation = sum({}, i % 2 == 0 ? 0 : 3, random.in_ball());
        shared += i % 3 == 1 // turned as files are, or by a pose
                      ? pairs_that_share(*Shape::make(placed(pair.a, pose)), {}, *Shape::make(placed(pair.b, pose)), {})
                      : pairs_that_share(*Shape::make(pair.a), pose, *Shape::make(pair.b), pose);
    }
    EXPECT_GT(shared, 1200);
    for (int i = 0; i < 600; ++i) {
        const auto a = Shape::make(coarse_solid(random)), b = Shape::make(coarse_solid(random));
        Pose pose = random.rotation();
        pose.translation = sum({}, 0.5 * (a->radius() + b->radius()), random.in_ball());
        shared += pairs_that_share(*a, {}, *b, pose);
    }
    EXPECT_GT(shared, 1500);
}

} // namespace
} // namespace raycontact::exact
