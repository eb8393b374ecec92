// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/solids.h"

#include "mesh/adjacency.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(Adjacency, BorderNeighbourAndManyAtOneEdge) {
    constexpr std::uint32_t none = 0xffffffffu;
    const Triangles two{{0, 1, 2}, {2, 1, 3}};
    EXPECT_EQ(triangle_neighbours(two), (Triangles{{none, 1, none}, {0, none, none}}));
    const Triangles three{{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {5, 5, 0}};
    EXPECT_EQ(triangle_neighbours(three),
              (Triangles{{1, none, none}, {0, none, none}, {0, none, none}, {none, none, none}}));
    const VertexTriangles around = vertex_triangles(three, 6);
    EXPECT_EQ(std::vector<std::uint32_t>(around.of(0).begin(), around.of(0).end()),
              (std::vector<std::uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(std::vector<std::uint32_t>(around.of(5).begin(), around.of(5).end()), (std::vector<std::uint32_t>{3}));
}

TEST(Prepare, BoxIsAsItShouldBe) {
    const MeshReport report = prepare_mesh(box(2)).report;
    EXPECT_EQ(report.vertices, 8u);
    EXPECT_EQ(report.triangles, 12u);
    EXPECT_TRUE(report.closed && report.manifold && report.oriented && report.outward);
    EXPECT_FALSE(report.self_intersecting);
    EXPECT_EQ(report.components, 1u);
    EXPECT_DOUBLE_EQ(report.volume, 8);
    EXPECT_DOUBLE_EQ(report.area, 24);
    EXPECT_EQ(report.box_max, (Vec3{2, 2, 2}));
    EXPECT_TRUE(report.repairs.empty());
}

TEST(Prepare, WeldsByPlaceAndKeepsTheLowestIndex) {
    Mesh mesh{"m",
              {{9, 9, 9}, {0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {0, 1, 0}, {0, 0, 1}},
              {{1, 2, 3}, {4, 5, 6}}};
    const PreparedMesh prepared = prepare_mesh(mesh);
    EXPECT_EQ(prepared.vertex_index, (std::vector<std::uint32_t>{1, 2, 3, 6}));
    EXPECT_EQ(prepared.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(prepared.report.file_vertices, 7u);
    EXPECT_FALSE(prepared.report.closed);
    EXPECT_TRUE(prepared.report.manifold && prepared.report.oriented);
    EXPECT_EQ(prepared.report.volume, 0);
}

TEST(Prepare, DropsDegenerateAndDuplicateTrianglesOnlyWhenAllowed) {
    Mesh mesh = box();
    mesh.vertices.push_back({0.25, 0, 0}); // on the edge from 0 to 1
    mesh.triangles.insert(mesh.triangles.begin(), {0, 8, 1});
    mesh.triangles.push_back({3, 3, 5});
    mesh.triangles.push_back(mesh.triangles[4]);
    std::rotate(mesh.triangles.back().begin(), mesh.triangles.back().begin() + 1, mesh.triangles.back().end());
    const PreparedMesh prepared = prepare_mesh(mesh);
    EXPECT_EQ(prepared.report.repairs,
              (std::vector<std::string>{"dropped 2 degenerate triangles", "dropped 1 duplicate triangle"}));
    EXPECT_EQ(prepared.report.triangles, 12u);
    EXPECT_EQ(prepared.report.vertices, 8u);
    EXPECT_EQ(prepared.triangle_index.front(), 1u);
    EXPECT_TRUE(prepared.report.outward);

    const PreparedMesh as_is = prepare_mesh(mesh, Repair::as_is);
    EXPECT_EQ(as_is.report.triangles, 15u);
    EXPECT_TRUE(as_is.report.repairs.empty());
    EXPECT_FALSE(as_is.report.manifold);
    EXPECT_TRUE(as_is.report.self_intersecting); // the duplicate
}

TEST(Prepare, OneTriangleTheOtherWay) {
    Mesh mesh = torus(8, 6, 1, 0.3);
    std::swap(mesh.triangles[7][1], mesh.triangles[7][2]);
    const PreparedMesh prepared = prepare_mesh(mesh);
    EXPECT_EQ(prepared.report.repairs, std::vector<std::string>{"turned 1 triangle to make windings agree"});
    EXPECT_TRUE(prepared.report.outward);
    const MeshReport as_is = prepare_mesh(mesh, Repair::as_is).report;
    EXPECT_TRUE(as_is.closed);
    EXPECT_FALSE(as_is.oriented);
    EXPECT_FALSE(as_is.outward);
}

TEST(Prepare, MoebiusStripStaysAsItIs) {
    Mesh mesh{"moebius", {}, {}};
    constexpr std::uint32_t n = 12;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double u = 6.283185307179586 * i / n;
        for (const double w : {-0.3, 0.3}) {
            const double r = 1 + w * std::cos(u / 2);
            mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), w * std::sin(u / 2)});
        }
        const std::uint32_t a = 2 * i, b = a + 1, c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
    }
    const MeshReport report = prepare_mesh(mesh).report;
    EXPECT_TRUE(report.manifold);
    EXPECT_FALSE(report.closed);
    EXPECT_FALSE(report.oriented);
    EXPECT_FALSE(report.outward);
    EXPECT_FALSE(report.self_intersecting);
    EXPECT_TRUE(report.repairs.empty());
}

TEST(Prepare, NonManifoldEdgesAndVertices) {
    const Mesh fin{"fin", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
    const MeshReport report = prepare_mesh(fin).report;
    EXPECT_FALSE(report.manifold);
    EXPECT_FALSE(report.closed);
    EXPECT_FALSE(report.self_intersecting);

    Mesh touching = box();
    append_box(touching, {1, 1, 1}, {2, 2, 2}); // one common vertex
    const MeshReport two = prepare_mesh(touching).report;
    EXPECT_EQ(two.vertices, 15u);
    EXPECT_EQ(two.components, 1u);
    EXPECT_FALSE(two.manifold);
    EXPECT_FALSE(two.self_intersecting);
    EXPECT_TRUE(two.closed && two.oriented && two.outward);

    Mesh edge = box();
    append_box(edge, {1, 1, 0}, {2, 2, 1}); // one common edge, four triangles around it
    const MeshReport four = prepare_mesh(edge).report;
    EXPECT_TRUE(four.closed && four.oriented && four.outward);
    EXPECT_FALSE(four.manifold || four.self_intersecting);
}

TEST(Prepare, RefusesWhatIsNoMesh) {
    EXPECT_THROW(prepare_mesh({"m", {}, {}}), InputError);
    EXPECT_THROW(prepare_mesh({"m", {{0, 0, 0}}, {{0, 0, 1}}}), InputError);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(prepare_mesh({"m", {{0, 0, nan}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}), InputError);
    EXPECT_THROW(prepare_mesh({"m", {{0, 0, 0}, {1e10, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}), InputError);
    const Mesh line{"m", {{0, 0, 0}, {0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}}, {{0, 1, 2}}};
    EXPECT_THROW(prepare_mesh(line), InputError);
    EXPECT_THROW(prepare_mesh(line, Repair::as_is), InputError);
}

/// Solids of all sorts: bumpy, nested, badly wound, with slivers and duplicates.
Mesh jumble(std::uint32_t seed) {
    std::mt19937 random(seed);
    Mesh mesh = torus(10 + seed % 5, 7, 1, 0.3, 0.2);
    Mesh inner = torus(12, 6, 1, 0.1);
    if (seed % 2) turn_over(inner);
    append(mesh, inner);
    append(mesh, box(0.5), {3, 0.1 * seed, 0});
    for (int i = 0; i < 5; ++i) {
        auto& t = mesh.triangles[random() % mesh.triangles.size()];
        std::swap(t[0], t[1]);
        mesh.triangles.push_back(mesh.triangles[random() % mesh.triangles.size()]);
        const auto v = static_cast<std::uint32_t>(random() % mesh.vertices.size());
        mesh.triangles.push_back({v, v, 0});
    }
    return mesh;
}

TEST(Prepare, IsIdempotent) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        const PreparedMesh once = prepare_mesh(jumble(seed));
        EXPECT_FALSE(once.report.repairs.empty());
        const PreparedMesh twice = prepare_mesh({once.name, once.vertices, once.triangles});
        EXPECT_EQ(twice.vertices, once.vertices);
        EXPECT_EQ(twice.triangles, once.triangles);
        EXPECT_TRUE(twice.report.repairs.empty());
        EXPECT_EQ(twice.report.volume, once.report.volume);
        EXPECT_TRUE(twice.report.outward);
    }
}

TEST(Prepare, OrderOfTrianglesDoesNotMatter) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        Mesh mesh = jumble(seed);
        const std::string report = to_json(prepare_mesh(mesh).report);
        std::mt19937 random(seed);
        for (std::size_t i = mesh.triangles.size(); i > 1; --i)
            std::swap(mesh.triangles[i - 1], mesh.triangles[random() % i]);
        EXPECT_EQ(to_json(prepare_mesh(mesh).report), report);
    }
}

} // namespace
