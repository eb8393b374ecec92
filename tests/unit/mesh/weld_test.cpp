// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/solids.h"

#include "mesh/vector.h"

#include <raycontact/collide.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>
#include <raycontact/shape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

using namespace raycontact;
using namespace raycontact::test;

namespace {

/// A vertex of its own for each corner, which differ from each other by at most `noise` along each axis.
Mesh soup(const Mesh& mesh, double noise, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> by(-noise / 2, noise / 2);
    Mesh out{mesh.name, {}, {}};
    for (const auto& t : mesh.triangles) {
        const auto base = static_cast<std::uint32_t>(out.vertices.size());
        for (const std::uint32_t v : t)
            out.vertices.push_back(mesh.vertices[v] + Vec3{by(random), by(random), by(random)});
        out.triangles.push_back({base, base + 1, base + 2});
    }
    return out;
}

Mesh shuffled(const Mesh& mesh, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> to(mesh.vertices.size());
    for (std::uint32_t v = 0; v < to.size(); ++v) to[v] = v;
    std::shuffle(to.begin(), to.end(), random);
    Mesh out(mesh);
    for (std::uint32_t v = 0; v < to.size(); ++v) out.vertices[to[v]] = mesh.vertices[v];
    for (auto& t : out.triangles)
        for (std::uint32_t& v : t) v = to[v];
    std::shuffle(out.triangles.begin(), out.triangles.end(), random);
    return out;
}

/// Where the corners of all triangles lie, in an order of its own.
std::multiset<std::tuple<double, double, double>> corners(const Mesh& mesh) {
    std::multiset<std::tuple<double, double, double>> all;
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) all.emplace(mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z);
    return all;
}

double deepest(const Mesh& a, const Mesh& b) {
    double depth = 0;
    for (const Contact& contact : collide(*Shape::make(a), {}, *Shape::make(b), {}))
        depth = std::max(depth, static_cast<double>(contact.depth));
    return depth;
}

TEST(Weld, ASoupWhoseCornersDifferIsAsDeepAsTheSolidThatItIs) {
    Mesh above; // reaches 0.1 into the box below, in its middle
    append_box(above, {0.4, 0.4, 0.9}, {0.6, 0.6, 1.7});
    const Mesh loose = soup(box(), 1e-7), loose_above = soup(above, 1e-7);
    EXPECT_NEAR(deepest(box(), above), 0.1, 1e-6);
    EXPECT_GT(deepest(box(), loose_above), 0.5); // open, it has no inside
    EXPECT_FALSE(prepare_mesh(loose).report.closed);
    EXPECT_NEAR(deepest(weld_mesh(loose, 1e-6), weld_mesh(loose_above, 1e-6)), 0.1, 1e-6);

    const PreparedMesh welded = prepare_mesh(weld_mesh(loose, 1e-6));
    EXPECT_TRUE(verdict_of(welded.report).good);
    EXPECT_EQ(welded.report.vertices, 8u);
    EXPECT_EQ(welded.report.file_vertices, 36u);
    ASSERT_EQ(welded.report.repairs.size(), 1u);
    EXPECT_TRUE(welded.report.repairs[0].starts_with("welded 28 vertices to others nearer than 1e-06 m, which moved"));
}

TEST(Weld, WhereVerticesGoIsByTheirPlacesNotTheirOrder) {
    const Mesh loose = soup(torus(30, 20, 1, 0.3), 0.02); // some clusters are longer than the length
    const auto welded = corners(weld_mesh(loose, 0.02));
    EXPECT_NE(welded, corners(loose));
    for (unsigned seed = 2; seed < 6; ++seed) EXPECT_EQ(corners(weld_mesh(shuffled(loose, seed), 0.02)), welded);
}

TEST(Weld, NoneMovesFartherAndNoTwoStayNearer) {
    for (const double length : {0.003, 0.05, 0.2, 3.0}) {
        const Mesh loose = soup(torus(24, 10, 1, 0.3), 0.05), welded = weld_mesh(loose, length);
        std::vector<Vec3> places;
        for (std::size_t v = 0; v < loose.vertices.size(); ++v) {
            EXPECT_LT(raycontact::length(welded.vertices[v] - loose.vertices[v]), length);
            places.push_back(welded.vertices[v]);
        }
        std::size_t near = 0, apart = 0;
        for (std::size_t a = 0; a < places.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) {
                if (places[a] == places[b]) continue;
                ++apart;
                if (raycontact::length(places[a] - places[b]) < length) ++near;
            }
        EXPECT_EQ(near, 0u) << length;
        EXPECT_EQ(apart > 0, length < 3) << length; // the whole torus is smaller
        EXPECT_EQ(welded.triangles, loose.triangles);
    }
}

TEST(Weld, TrianglesThatLoseTheirAreaAreDroppedAndCounted) {
    Mesh mesh = box();
    // One corner is two, 1e-5 apart: the side between them becomes two triangles more.
    mesh.vertices.push_back({1 + 1e-5, 1, 1});
    mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 8}, {1, 8, 5}, {0, 1, 5}, {0, 5, 4}, {0, 2, 3},
                      {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {2, 6, 7}, {2, 7, 3}, {5, 8, 7}, {3, 7, 8}};
    ASSERT_TRUE(prepare_mesh(mesh).report.closed);
    const MeshReport report = prepare_mesh(weld_mesh(mesh, 1e-4)).report;
    EXPECT_TRUE(verdict_of(report).good);
    EXPECT_EQ(report.triangles, 12u);
    ASSERT_EQ(report.repairs.size(), 2u);
    EXPECT_TRUE(report.repairs[0].starts_with("welded 1 vertex to"));
    EXPECT_EQ(report.repairs[1], "dropped 2 degenerate triangles");
}

TEST(Weld, WhatNoTriangleUsesJoinsNothing) {
    Mesh mesh = box();
    mesh.vertices.insert(mesh.vertices.begin(), {-1e-7, 0, 0});
    for (auto& t : mesh.triangles)
        for (std::uint32_t& v : t) ++v;
    const Mesh welded = weld_mesh(mesh, 1e-6);
    EXPECT_EQ(welded.vertices, mesh.vertices);
    EXPECT_TRUE(welded.repairs.empty());
}

TEST(Weld, RefusesLengthsAndPlacesThatMakeNoSense) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double length : {0.0, -1.0, 1e-13, 1e10, nan}) EXPECT_THROW(weld_mesh(box(), length), InputError);
    Mesh bad = box();
    bad.vertices[0].x = nan;
    EXPECT_THROW(weld_mesh(bad, 1), InputError);
    // Below the last digit nothing can be nearer.
    try {
        weld_mesh(box(1e9), 1e-7);
        ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "box: cannot be welded by 1e-07 m: as far from the origin as it is, coordinates "
                                   "have no digits below 1.19209e-07 m; give a greater length");
    }
    EXPECT_EQ(weld_mesh(box(1e9), 1.2e-7).vertices, box(1e9).vertices);
}

TEST(Weld, MillimetresOfAMapAreWelded) {
    Mesh loose = soup(torus(30, 20, 1000, 300), 2e-4);
    const std::size_t welded_near = prepare_mesh(weld_mesh(loose, 1e-3)).report.vertices;
    for (Vec3& v : loose.vertices) v = v + Vec3{691234567.25, 5334567890.5, 512125};
    Mesh welded = weld_mesh(loose, 1e-3);
    ASSERT_EQ(welded.repairs.size(), 1u);
    for (Vec3& v : welded.vertices) v = v - Vec3{691234567.25, 5334567890.5, 512125};
    const MeshReport report = prepare_mesh(welded).report;
    EXPECT_TRUE(verdict_of(report).good);
    EXPECT_EQ(report.vertices, welded_near);
    EXPECT_EQ(report.vertices, 600u);
    EXPECT_THROW(weld_mesh(loose, 9e-7), InputError); // its last digit is 9.5e-7
}

TEST(Weld, ALengthIsProposedWhereItCloses) {
    const auto proposed = [](const Mesh& mesh) { return closing_weld(prepare_mesh(mesh)); };
    const std::optional<double> length = proposed(soup(torus(30, 20, 1, 0.3), 1e-7));
    ASSERT_TRUE(length);
    EXPECT_EQ(*length, 1e-6); // corners of a cluster may be 1.7e-7 apart
    EXPECT_EQ(proposed(soup(torus(30, 20, 1000, 300), 1e-4)), 1e-3);
    EXPECT_FALSE(proposed(box())); // closed
    Mesh open = box();
    open.triangles.pop_back();
    EXPECT_FALSE(proposed(open));
    EXPECT_FALSE(proposed(soup(open, 1e-7)));
    EXPECT_FALSE(proposed(soup(box(), 1e-2))); // more than last digits
}

} // namespace
