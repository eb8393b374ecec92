// SPDX-License-Identifier: Apache-2.0
// T-junctions: a vertex of one border lies on an edge of another.
#include "tests/time_limit.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/collide.h>
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

/// A box whose top is cut in four, while the sides keep whole edges.
Mesh box_with_cut_top() {
    Mesh mesh = box();
    mesh.triangles.erase(mesh.triangles.end() - 2, mesh.triangles.end()); // the top: 4 5 7 6
    for (const Vec3& v : {Vec3{0.5, 0, 1}, Vec3{1, 0.5, 1}, Vec3{0.5, 1, 1}, Vec3{0, 0.5, 1}, Vec3{0.5, 0.5, 1}})
        mesh.vertices.push_back(v);
    for (const auto& [a, b, c, d] : std::array<std::array<std::uint32_t, 4>, 4>{
             {{4, 8, 12, 11}, {8, 5, 9, 12}, {12, 9, 7, 10}, {11, 12, 10, 6}}}) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    }
    return mesh;
}

Vec3 between(const Vec3& p, const Vec3& q, double at) {
    return {p.x + at * (q.x - p.x), p.y + at * (q.y - p.y), p.z + at * (q.z - p.z)};
}

/// Splits triangles of a closed mesh at places along their edges; the ones across do not know.
std::size_t cut_at_random(Mesh& mesh, std::mt19937& random, double digit) {
    const auto part = [&] { return 0.1 + 0.8 * double(random()) / 4294967296.0; };
    const auto in_digits = [&](double x) { return digit > 0 ? std::round(x / digit) * digit : x; };
    std::size_t cuts = 0;
    for (std::size_t t = 0, count = mesh.triangles.size(); t < count; ++t) {
        if (random() % 3 != 0) continue;
        const auto [a, b, c] = mesh.triangles[t];
        const Vec3 m_at = between(mesh.vertices[a], mesh.vertices[b], part());
        mesh.vertices.push_back({in_digits(m_at.x), in_digits(m_at.y), in_digits(m_at.z)});
        const auto m = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
        mesh.triangles[t] = {a, m, c};
        mesh.triangles.push_back({m, b, c});
        ++cuts;
    }
    return cuts;
}

TEST(Stitch, ABoxWhoseTopIsCutIsClosed) {
    const PreparedMesh mesh = prepare_mesh(box_with_cut_top());
    EXPECT_TRUE(mesh.report.closed && mesh.report.manifold && mesh.report.oriented && mesh.report.outward);
    EXPECT_FALSE(mesh.report.self_intersecting);
    EXPECT_DOUBLE_EQ(mesh.report.volume, 1);
    EXPECT_DOUBLE_EQ(mesh.report.area, 6);
    EXPECT_EQ(mesh.report.triangles, 22u);
    EXPECT_EQ(mesh.report.file_triangles, 18u);
    EXPECT_EQ(mesh.report.repairs, (std::vector<std::string>{"split 4 triangles at 4 T-junctions"}));
    // The pieces of a triangle follow each other and have its number.
    EXPECT_TRUE(std::ranges::is_sorted(mesh.triangle_index));
    for (std::uint32_t t = 0; t < 18; ++t) EXPECT_LE(std::ranges::count(mesh.triangle_index, t), 2) << t;
    const auto shape = Shape::make(box_with_cut_top());
    EXPECT_TRUE(contains(*shape, Pose{}, {0.5, 0.5, 0.5}));
    EXPECT_TRUE(verdict_of(shape->report()).good);
}

TEST(Stitch, PiecesKeepTheirTrianglesCorners) {
    const Mesh file = box_with_cut_top();
    const PreparedMesh mesh = prepare_mesh(file);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& whole = file.triangles[mesh.triangle_index[t]];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t corner = mesh.vertex_index[mesh.triangles[t][k]];
            const bool is_whole = std::ranges::find(whole, corner) != whole.end();
            EXPECT_TRUE(!is_whole || corner == whole[k]) << t << ' ' << k;
        }
    }
}

TEST(Stitch, QueriesAndContactsNameTheTrianglesOfTheFile) {
    const Mesh file = box_with_cut_top();
    const auto shape = Shape::make(file), small = Shape::make(box(0.1));
    // The side at y = 0 is two triangles of the file and three of the shape.
    std::set<std::uint32_t> hit;
    for (const double x : {0.1, 0.3, 0.6, 0.98}) {
        const auto found = raycast(*shape, {}, {x, -1, 0.95}, {0, 1, 0});
        ASSERT_TRUE(found);
        hit.insert(found->triangle);
    }
    EXPECT_EQ(hit, (std::set<std::uint32_t>{4, 5}));
    std::size_t contacts = 0;
    for (const double x : {0.1, 0.45, 0.8})
        for (const Contact& c : collide(*shape, {}, *small, {.translation = {x, -0.08, 0.85}})) {
            const bool is_vertex = c.feature.kind == FeatureKind::vertex && c.feature.source == Side::b;
            EXPECT_TRUE(!is_vertex || c.feature.other_index() < 18u);
            EXPECT_TRUE(c.feature.kind != FeatureKind::edges || c.feature.index_a < 3 * 18u);
            EXPECT_LE(c.depth, 0.06F);
            ++contacts;
        }
    EXPECT_GE(contacts, 12u);
}

TEST(Stitch, NothingIsSplitAsItIs) {
    const PreparedMesh mesh = prepare_mesh(box_with_cut_top(), {.repair = Repair::as_is});
    EXPECT_EQ(mesh.report.triangles, 18u);
    EXPECT_FALSE(mesh.report.closed);
    EXPECT_TRUE(mesh.report.repairs.empty());
}

TEST(Stitch, SeveralVerticesOnAllEdgesOfATriangle) {
    // A tetrahedron whose base is one triangle; the sides have each edge of it in four.
    Mesh mesh{"tetrahedron", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}, {{0, 2, 1}}};
    for (const auto& [a, b] : std::array<std::array<std::uint32_t, 2>, 3>{{{0, 1}, {1, 2}, {2, 0}}}) {
        std::uint32_t last = a;
        for (int i = 1; i <= 4; ++i) {
            std::uint32_t next = b;
            if (i < 4) {
                next = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(between(mesh.vertices[a], mesh.vertices[b], 0.25 * i));
            }
            mesh.triangles.push_back({last, next, 3});
            last = next;
        }
    }
    const MeshReport report = prepare_mesh(mesh).report;
    EXPECT_TRUE(report.closed && report.outward && report.manifold);
    EXPECT_EQ(report.triangles, 10u + 12u);
    EXPECT_NEAR(report.volume, 64.0 / 6, 1e-12);
    EXPECT_EQ(report.repairs, (std::vector<std::string>{"split 1 triangle at 9 T-junctions"}));
}

TEST(Stitch, EdgesThatOverlapAreCutAtEachOther) {
    // Two flaps share the line from 1 to 2: one has 0 to 2 of it, the other 1 to 3.
    const Mesh mesh{
        "flaps", {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 0, 0}, {3, 0, 0}, {2, -1, 0}}, {{0, 1, 2}, {4, 3, 5}}};
    const PreparedMesh stitched = prepare_mesh(mesh);
    EXPECT_EQ(stitched.report.triangles, 4u);
    EXPECT_EQ(stitched.report.border_edges, 6u);
    EXPECT_FALSE(stitched.report.self_intersecting);
}

TEST(Stitch, ClosedMeshesCutAtRandomCloseAgain) {
    std::mt19937 random(65);
    for (const double digit : {0.0, 1e-6, 1e-5}) {
        Mesh mesh = torus(40, 24, 1, 0.4);
        if (digit > 0)
            for (Vec3& v : mesh.vertices)
                v = {std::round(v.x / digit) * digit, std::round(v.y / digit) * digit, std::round(v.z / digit) * digit};
        const MeshReport before = prepare_mesh(mesh).report;
        const std::size_t cuts = cut_at_random(mesh, random, digit);
        ASSERT_GT(cuts, 400u);
        const MeshReport after = prepare_mesh(mesh).report;
        EXPECT_TRUE(after.closed && after.oriented && after.manifold) << digit;
        EXPECT_EQ(after.triangles, before.triangles + 2 * cuts);
        EXPECT_NEAR(after.volume, before.volume, 1e-9 + 4 * digit);
        ASSERT_EQ(after.repairs.size(), 1u);
        EXPECT_NE(after.repairs[0].find("T-junction"), std::string::npos);
        EXPECT_NE(after.repairs[0].find("m beside its edge"), std::string::npos) << after.repairs[0];
    }
}

TEST(Stitch, FloatsLieBesideByTheirLastDigit) {
    std::mt19937 random(66);
    Mesh mesh = torus(30, 20, 1, 0.4);
    cut_at_random(mesh, random, 0);
    for (Vec3& v : mesh.vertices) v = rounded(v);
    EXPECT_TRUE(prepare_mesh(mesh).report.closed);
}

TEST(Stitch, WhatLiesFartherOffIsNone) {
    Mesh mesh = box_with_cut_top();
    mesh.vertices[8].y = -1e-3;
    const MeshReport report = prepare_mesh(mesh, {.holes = Holes::none}).report;
    EXPECT_FALSE(report.closed);
    EXPECT_EQ(report.repairs, (std::vector<std::string>{"split 3 triangles at 3 T-junctions"}));
}

TEST(Stitch, ManyEdgesOnOneLineTakeNoLongerThanTheyAreMany) {
    const TimeLimit limit(20);
    Mesh mesh{"fan", {}, {}};
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const double x = 4.0 * i; // farther apart than the last digit
        for (const Vec3& v : {Vec3{-x - 1, 0, 0}, Vec3{x + 1, 0, 0}, Vec3{0, 1, x}}) mesh.vertices.push_back(v);
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const MeshReport report = prepare_mesh(mesh, {.check = Check::topology}).report;
    ASSERT_EQ(report.repairs.size(), 1u);
    EXPECT_EQ(report.repairs[0], "left T-junctions as they are: too many vertices lie on borders of others");
    EXPECT_EQ(report.triangles, 100'000u);
}

} // namespace
