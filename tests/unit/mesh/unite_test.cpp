// SPDX-License-Identifier: Apache-2.0
// Parts of one mesh that cross or lie in each other are one solid.
#include "tests/time_limit.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/collide.h>
#include <raycontact/error.h>
#include <raycontact/mass.h>
#include <raycontact/mesh.h>
#include <raycontact/query.h>
#include <raycontact/shape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

using namespace raycontact;
using namespace raycontact::test;

namespace {

double random_unit(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

/// Turned by a rotation that no axis is left in.
Mesh turned(Mesh mesh, std::mt19937& random) {
    const double a = 6.3 * random_unit(random), b = 6.3 * random_unit(random);
    for (Vec3& v : mesh.vertices) {
        v = {std::cos(a) * v.x - std::sin(a) * v.y, std::sin(a) * v.x + std::cos(a) * v.y, v.z};
        v = {v.x, std::cos(b) * v.y - std::sin(b) * v.z, std::sin(b) * v.y + std::cos(b) * v.z};
    }
    return mesh;
}

Mesh all_of(const std::vector<Mesh>& parts) {
    Mesh mesh{"parts", {}, {}};
    for (const Mesh& part : parts) append(mesh, part);
    return mesh;
}

/// A mesh is the union of its parts: it is good, and a point lies in it that lies in one of them.
void expect_union(const std::vector<Mesh>& parts, std::uint32_t seed, std::size_t points) {
    SCOPED_TRACE(seed);
    const PreparedMesh mesh = prepare_mesh(all_of(parts));
    EXPECT_TRUE(mesh.report.closed && mesh.report.oriented && mesh.report.outward && !mesh.report.self_intersecting)
        << to_text(mesh.report);
    EXPECT_TRUE(std::ranges::is_sorted(mesh.triangle_index) && std::ranges::is_sorted(mesh.vertex_index));
    EXPECT_EQ(std::set(mesh.vertex_index.begin(), mesh.vertex_index.end()).size(), mesh.vertices.size());
    const auto shape = Shape::make(mesh);
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Mesh& part : parts) shapes.push_back(Shape::make(part));
    std::mt19937 random(seed);
    std::size_t inside = 0;
    const auto &low = mesh.report.box_min, &high = mesh.report.box_max;
    for (std::size_t i = 0; i < points; ++i) {
        const Vec3 p{low.x + random_unit(random) * (high.x - low.x), low.y + random_unit(random) * (high.y - low.y),
                     low.z + random_unit(random) * (high.z - low.z)};
        const bool expected = std::ranges::any_of(shapes, [&](const auto& part) { return contains(*part, p); });
        EXPECT_EQ(contains(*shape, p), expected) << p.x << ' ' << p.y << ' ' << p.z;
        inside += expected;
    }
    EXPECT_GT(inside, points / 100);
}

TEST(Unite, TurnedPartsThatCross) {
    std::mt19937 random(1);
    std::size_t united = 0;
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        std::vector<Mesh> parts;
        for (std::uint32_t i = 0; i < 2 + seed % 4; ++i) {
            Mesh part = i % 2 == 0 ? turned(torus(12, 8, 0.5, 0.2), random) : turned(box(0.7), random);
            for (Vec3& v : part.vertices) v = {v.x + 0.3 * i, v.y, v.z};
            parts.push_back(part);
        }
        united += prepare_mesh(all_of(parts)).report.repairs.size();
        expect_union(parts, seed, 300);
    }
    EXPECT_GT(united, 50u);
}

// Boxes of a lattice: their faces lie in each other's planes, on each other, edges cross edges and corners.
TEST(Unite, BoxesThatShareFacesEdgesAndCorners) {
    std::mt19937 random(2);
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        std::vector<Mesh> parts;
        for (std::uint32_t i = 0; i < 2 + seed % 5; ++i) {
            std::array<double, 3> low{}, high{};
            for (std::size_t k = 0; k < 3; ++k) {
                low[k] = double(random() % 4);
                high[k] = low[k] + 1 + double(random() % 3);
            }
            Mesh part{"box", {}, {}};
            append_box(part, {low[0], low[1], low[2]}, {high[0], high[1], high[2]});
            parts.push_back(part);
        }
        expect_union(parts, seed, 200);
        // The volume in unit cells.
        double cells = 0;
        std::vector<std::shared_ptr<const Shape>> shapes;
        for (const Mesh& part : parts) shapes.push_back(Shape::make(part));
        for (int c = 0; c < 343; ++c) {
            const Vec3 middle{c % 7 + 0.5, c / 7 % 7 + 0.5, c / 49 + 0.5};
            cells += std::ranges::any_of(shapes, [&](const auto& part) { return contains(*part, middle); });
        }
        EXPECT_NEAR(prepare_mesh(all_of(parts)).report.volume, cells, 1e-9);
    }
}

// Ridges on ridges, a prism of many sides through a plate: many cuts of one triangle.
/// A rectangle (r, z) turned about z.
Mesh ring(int around, double inner, double outer, double low, double high) {
    Mesh mesh{"ring", {}, {}};
    const std::array<std::array<double, 2>, 4> profile{{{inner, low}, {outer, low}, {outer, high}, {inner, high}}};
    for (int i = 0; i < around; ++i)
        for (const auto& [r, z] : profile) {
            const double angle = 2 * 3.14159265358979323846 * i / around;
            mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
        }
    const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i % around * 4 + k % 4); };
    for (int i = 0; i < around; ++i)
        for (int k = 0; k < 4; ++k) {
            mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    return mesh;
}

// Corners of formulas lie on edges of each other but for the last bit: a cup of a wall and a bottom.
TEST(Unite, PartsWhoseCornersNearlyLieOnEachOthersEdges) {
    struct Cup {
        double wall_low, bottom_low;
    };
    for (const Cup cup : {Cup{0, 0}, Cup{-0.01, 0}, Cup{0, -0.01}})
        for (const int around : {3, 4, 5, 8, 12, 16, 32, 64}) {
            const auto shape = Shape::make(all_of(
                {ring(around, 0.036, 0.04, cup.wall_low, 0.1), ring(around, 0.001, 0.038, cup.bottom_low, 0.006)}));
            ASSERT_TRUE(shape->has_inside()) << around;
            EXPECT_TRUE(verdict_of(shape->report()).good) << around << ", " << cup.wall_low;
            const double square = 0.5 * around * std::sin(2 * 3.14159265358979323846 / around); // of radius 1
            const auto band = [&](double inner, double outer) { return square * (outer * outer - inner * inner); };
            const double below = std::max(cup.wall_low - cup.bottom_low, 0.0);
            const double volume = band(0.036, 0.04) * (0.1 - cup.wall_low) + band(0.001, 0.038) * below
                                  + band(0.001, 0.036) * (0.006 - std::max(cup.wall_low, cup.bottom_low));
            const double own = mass_of(shape->file_vertices(), shape->triangles()).volume;
            EXPECT_NEAR(own, volume, 1e-7 * volume) << around << ", " << cup.wall_low << ", " << cup.bottom_low;
        }
}

TEST(Unite, AFineRodThroughAPlate) {
    Mesh rod{"rod", {{0, 0, -1}, {0, 0, 1}}, {}};
    constexpr std::uint32_t sides = 96;
    for (std::uint32_t i = 0; i < sides; ++i) {
        const double turn = 6.283185307179586 * i / sides;
        for (const double z : {-1.0, 1.0}) rod.vertices.push_back({0.3 * std::cos(turn), 0.3 * std::sin(turn), z});
        const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % sides);
        for (const auto& t : {std::array{a, b, b + 1}, {a, b + 1, a + 1}, {0u, b, a}, {1u, a + 1, b + 1}})
            rod.triangles.push_back(t);
    }
    Mesh plate{"plate", {}, {}};
    append_box(plate, {-1, -1, -0.1}, {1, 1, 0.1});
    expect_union({plate, rod}, 1, 1000);
    const double area = 0.5 * sides * 0.09 * std::sin(6.283185307179586 / sides);
    EXPECT_NEAR(prepare_mesh(all_of({plate, rod})).report.volume, 4 * 0.2 + area * 1.8, 1e-12);
    expect_union({plate, rod, box(0.5)}, 2, 1000);
}

TEST(Unite, WhatLiesInsideGoesAndCavitiesStay) {
    Mesh nested = box(4), cavity = nested, inner = box();
    append(nested, inner, {1, 1, 1});
    turn_over(inner);
    append(cavity, inner, {1, 1, 1});
    const PreparedMesh solid = prepare_mesh(nested), hollow = prepare_mesh(cavity);
    EXPECT_EQ(solid.report.volume, 64);
    EXPECT_EQ(solid.report.triangles, 12u);
    EXPECT_EQ(solid.report.repairs[0],
              "united parts that lie in each other: split 0 triangles, dropped 12 buried ones");
    EXPECT_EQ(hollow.report.volume, 63);
    EXPECT_TRUE(hollow.report.repairs.empty());
}

TEST(Unite, PiecesLieInTheirTrianglesAndNameThem) {
    Mesh mesh = box(2);
    append(mesh, box(2), {0.7, 0.6, 0.5});
    const PreparedMesh united = prepare_mesh(mesh);
    EXPECT_GT(united.triangles.size(), mesh.triangles.size());
    for (std::size_t t = 0; t < united.triangles.size(); ++t) {
        const auto& whole = mesh.triangles[united.triangle_index[t]];
        const Vec3 &a = mesh.vertices[whole[0]], &b = mesh.vertices[whole[1]], &c = mesh.vertices[whole[2]];
        const Vec3 n{(b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y),
                     (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z),
                     (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)};
        for (const std::uint32_t v : united.triangles[t]) {
            const Vec3& p = united.vertices[v];
            EXPECT_NEAR(n.x * (p.x - a.x) + n.y * (p.y - a.y) + n.z * (p.z - a.z), 0, 1e-14);
            const std::uint32_t in_file = united.vertex_index[v];
            if (in_file < mesh.vertices.size()) {
                EXPECT_EQ(p, mesh.vertices[in_file]);
            }
        }
        for (std::size_t k = 0; k < 3; ++k) // a corner of the triangle is where the triangle has it
            for (std::size_t m = 0; m < 3; ++m)
                if (united.vertices[united.triangles[t][k]] == mesh.vertices[whole[m]]) {
                    EXPECT_EQ(k, m) << t;
                }
    }
}

// What is cut off from the surface by another part stops nothing and hides nothing.
TEST(Unite, ContactsAreWithTheOuterSurfaceAlone) {
    Mesh cross{"cross", {}, {}};
    append_box(cross, {-2, -0.5, -0.5}, {2, 0.5, 0.5});
    append_box(cross, {-0.5, -2, -0.5}, {0.5, 2, 0.5});
    append_box(cross, {-0.5, -0.5, -2}, {0.5, 0.5, 2});
    const auto shape = Shape::make(cross), ball = Shape::make(torus(16, 12, 0.15, 0.1));
    const auto bare = Shape::make(prepare_mesh(cross, {.overlaps = Overlaps::leave}));
    std::mt19937 random(3);
    std::size_t contacts = 0, buried = 0;
    for (int i = 0; i < 400; ++i) {
        const auto place = [&] { return 3.0 * random_unit(random) - 1.5; };
        const Pose at{.translation = {place(), place(), place()}};
        const auto found = collide(*shape, {}, *ball, at, {.direction = Direction::ray});
        EXPECT_EQ(!found.empty() || contains(*shape, at, {}), intersects(*shape, {}, *ball, at)) << i;
        // Where a ray ends that a vertex of the ball casts.
        const auto is_buried = [&](const Contact& c) {
            const Vec3& p = c.point_a;
            return c.feature.kind == FeatureKind::vertex && c.feature.source == Side::b
                   && signed_distance(*shape, {}, std::span(&p, 1))[0].distance < -1e-5;
        };
        for (const Contact& c : found) EXPECT_FALSE(is_buried(c)) << i;
        contacts += found.size();
        for (const Contact& c : collide(*bare, {}, *ball, at, {.direction = Direction::ray})) buried += is_buried(c);
    }
    EXPECT_GT(contacts, 500u);
    EXPECT_GT(buried, 100u); // of parts that are left as they are
}

TEST(Unite, ContactsOfCutEdgesHaveKeysOfTheirOwn) {
    Mesh bars{"bars", {}, {}};
    for (const double at : {-0.3, 0.0, 0.3, 0.6}) {
        append_box(bars, {-1, at, -0.05}, {1, at + 0.1, 0.05});
        append_box(bars, {at, -1, -0.05}, {at + 0.1, 1, 0.05});
    }
    const auto lattice = Shape::make(bars), cube = Shape::make(box(0.8));
    std::mt19937 random(7);
    std::size_t edges = 0;
    for (int i = 0; i < 60; ++i) {
        const auto place = [&] { return random_unit(random) - 0.9; };
        const double angle = 6.3 * random_unit(random), c = std::cos(angle), s = std::sin(angle);
        const Pose at{.rotation = {c, -s, 0, s, c, 0, 0, 0, 1}, .translation = {place(), place(), 0.3 * place()}};
        std::set<std::uint64_t> keys;
        const auto found = collide(*lattice, {}, *cube, at);
        for (const Contact& contact : found) {
            EXPECT_TRUE(keys.insert(contact.key()).second) << i;
            edges += contact.feature.kind == FeatureKind::edges;
        }
    }
    EXPECT_GT(edges, 100u);
}

// What spans a hole may be cut or buried.
TEST(Unite, HolesOfPartsThatCross) {
    Mesh mesh{"tube in box", {}, {}};
    append_box(mesh, {-1, -1, -1}, {1, 1, 1});
    constexpr std::uint32_t sides = 60;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i < sides; ++i) // closed below, open above, inside the box
        for (const double z : {-0.5, 0.5})
            mesh.vertices.push_back(
                {0.2 * std::cos(6.283185307179586 * i / sides), 0.2 * std::sin(6.283185307179586 * i / sides), z});
    mesh.vertices.push_back({0, 0, -0.5});
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t a = base + 2 * i, b = base + 2 * ((i + 1) % sides);
        for (const auto& t : {std::array{a, b, b + 1}, {a, b + 1, a + 1}, {base + 2 * sides, b, a}})
            mesh.triangles.push_back(t);
    }
    const PreparedMesh prepared = prepare_mesh(mesh);
    EXPECT_EQ(prepared.report.holes, 1u);
    EXPECT_EQ(prepared.report.spanning, 0u); // gone with the tube
    EXPECT_EQ(prepared.report.triangles, 12u);
    EXPECT_FALSE(closing_weld(prepared));
}

TEST(Unite, FarFromTheOrigin) {
    std::mt19937 random(9);
    for (const double offset : {0.0, 1e3, 1e5}) {
        Mesh mesh{"far", {}, {}};
        for (int i = 0; i < 10; ++i) {
            const Mesh part = turned(box(1.3), random);
            append(mesh, part, {offset + random_unit(random), random_unit(random), random_unit(random)});
        }
        const PreparedMesh united = prepare_mesh(mesh);
        EXPECT_TRUE(united.report.closed && united.report.outward && !united.report.self_intersecting)
            << offset << to_text(united.report);
    }
}

TEST(Unite, OnceIsEnoughAndThreadsDoNotMatter) {
    std::mt19937 random(5);
    for (int i = 0; i < 10; ++i) {
        Mesh mesh = turned(torus(16, 10, 1, 0.4), random);
        append(mesh, turned(torus(16, 10, 1, 0.4), random), {0.5, 0.1, 0.2});
        const PreparedMesh one = prepare_mesh(mesh, {.threads = 1}), many = prepare_mesh(mesh, {.threads = 6});
        EXPECT_EQ(one.triangles, many.triangles);
        EXPECT_EQ(one.vertices, many.vertices);
        EXPECT_EQ(one.triangle_index, many.triangle_index);
        const PreparedMesh again = prepare_mesh({"again", one.vertices, one.triangles});
        EXPECT_EQ(again.triangles, one.triangles);
        EXPECT_TRUE(again.report.repairs.empty());
        const PreparedMesh left = prepare_mesh(mesh, {.overlaps = Overlaps::leave});
        EXPECT_TRUE(left.report.self_intersecting && left.report.repairs.empty());
        EXPECT_EQ(left.triangles, mesh.triangles);
    }
}

TEST(Unite, TooManyThatCrossAreLeftAndNamed) {
    const TimeLimit limit(60);
    std::mt19937 random(6);
    Mesh mesh{"heap", {}, {}};
    for (int i = 0; i < 400; ++i) append(mesh, turned(box(), random), {random_unit(random), random_unit(random), 0});
    const MeshReport report = prepare_mesh(mesh, {.check = Check::topology}).report;
    ASSERT_EQ(report.repairs.size(), 1u);
    EXPECT_EQ(report.repairs[0], "left parts that cross as they are: too many, or too near");
    EXPECT_EQ(report.triangles, 4800u);
}

} // namespace
