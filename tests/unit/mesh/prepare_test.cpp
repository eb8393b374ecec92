// SPDX-License-Identifier: Apache-2.0
#include "tests/time_limit.h"
#include "tests/unit/mesh/solids.h"

#include "mesh/adjacency.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>
#include <raycontact/shape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(Adjacency, BorderNeighbourAndManyAtOneEdge) {
    constexpr std::uint32_t none = 0xffffffffu;
    const Triangles two{{0, 1, 2}, {2, 1, 3}};
    const std::vector<Vec3> at{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
    EXPECT_EQ(triangle_neighbours(two, at), (Triangles{{none, 1, none}, {0, none, none}}));
    const Triangles three{{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {5, 5, 0}};
    // The solid behind 0 and 2; what is behind 1 has no other side.
    EXPECT_EQ(triangle_neighbours(three, at),
              (Triangles{{2, none, none}, {0, none, none}, {0, none, none}, {none, none, none}}));
    const VertexTriangles around = vertex_triangles(three, 6);
    EXPECT_EQ(std::vector<std::uint32_t>(around.of(0).begin(), around.of(0).end()),
              (std::vector<std::uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(std::vector<std::uint32_t>(around.of(5).begin(), around.of(5).end()), (std::vector<std::uint32_t>{3}));
}

// Boxes that touch in an edge, in whatever order: across an edge lies a face of the same box.
TEST(Adjacency, SolidsThatTouchInAnEdgeAreSolidsOfTheirOwn) {
    std::mt19937 random(3);
    for (int turn = 0; turn < 50; ++turn) {
        Mesh mesh{"boxes", {}, {}};
        append_box(mesh, {0, 0, 0}, {1, 1, 1});
        append_box(mesh, {1, 1, 0}, {2, 2, 1});
        if (turn % 2 == 0) append_box(mesh, {1, 0, 1}, {2, 1, 2});
        std::vector<std::uint32_t> order(mesh.triangles.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::shuffle(order, random);
        Triangles shuffled;
        for (const std::uint32_t t : order) shuffled.push_back(mesh.triangles[t]);
        mesh.triangles = shuffled;
        const PreparedMesh prepared = prepare_mesh(mesh);
        ASSERT_FALSE(prepared.report.manifold);
        ASSERT_TRUE(prepared.report.outward);
        const auto neighbours = triangle_neighbours(prepared.triangles, prepared.vertices);
        for (std::uint32_t t = 0; t < neighbours.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_EQ(order[t] / 12, order[neighbours[t][k]] / 12) << t;
                EXPECT_EQ(std::ranges::count(neighbours[neighbours[t][k]], t), 1);
            }
    }
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

TEST(Prepare, ASolidThatIsThereTwiceBackToBackIsOne) {
    Mesh mesh = torus(12, 8, 1, 0.4), back = mesh;
    turn_over(back);
    append(mesh, back);
    const MeshReport report = prepare_mesh(mesh).report, once = prepare_mesh(torus(12, 8, 1, 0.4)).report;
    EXPECT_TRUE(report.outward);
    EXPECT_EQ(report.triangles, once.triangles);
    EXPECT_DOUBLE_EQ(report.volume, once.volume);
    EXPECT_EQ(report.repairs, (std::vector<std::string>{"dropped 192 triangles back to back with another"}));
    EXPECT_EQ(prepare_mesh(mesh, {.repair = Repair::as_is}).report.triangles, 384u);
    // A sheet with two sides has no inside either way; it stays. The two halves of a lens that share a disc are one.
    Mesh sheet{"sheet", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}}};
    EXPECT_EQ(prepare_mesh(sheet).report.triangles, 4u);
    Mesh halves{"halves",
                {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}},
                {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 1, 2}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}}};
    EXPECT_EQ(prepare_mesh(halves).report.triangles, 6u);
    EXPECT_EQ(prepare_mesh(halves, {.overlaps = Overlaps::leave}).report.triangles, 8u);
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

    const PreparedMesh as_is = prepare_mesh(mesh, {.repair = Repair::as_is});
    EXPECT_EQ(as_is.report.triangles, 15u);
    EXPECT_TRUE(as_is.report.repairs.empty());
    EXPECT_FALSE(as_is.report.manifold);
    EXPECT_TRUE(as_is.report.self_intersecting); // the duplicate
}

/// Puts a corner on an edge of a closed mesh: the triangle on one side is halved there, and a degenerate one joins both
/// halves to the whole one on the other side. Closed, as exporters of STL leave it.
void add_corner_on_edge(Mesh& mesh, std::uint32_t triangle, std::size_t side) {
    const auto [a, b, c] = [&] {
        auto t = mesh.triangles[triangle];
        std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(side), t.end());
        return t;
    }();
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2}); // exact: coordinates are multiples
    mesh.triangles[triangle] = {a, middle, c};
    mesh.triangles.push_back({middle, b, c});
    mesh.triangles.push_back({a, b, middle});
}

/// A torus whose coordinates can be halved many times without a rounding.
Mesh lattice_torus(std::uint32_t around, std::uint32_t across) {
    Mesh mesh = torus(around, across, 1, 0.3);
    const auto round = [](double x) { return std::round(x * 1024) / 1024; };
    for (Vec3& v : mesh.vertices) v = {round(v.x), round(v.y), round(v.z)};
    return mesh;
}

TEST(Repair, ACornerOnASideDoesNotOpenAClosedMesh) {
    Mesh mesh = box();
    add_corner_on_edge(mesh, 4, 1);
    ASSERT_TRUE(prepare_mesh(mesh, {.repair = Repair::as_is}).report.closed);
    const PreparedMesh prepared = prepare_mesh(mesh);
    EXPECT_EQ(prepared.report.repairs,
              (std::vector<std::string>{"split 1 triangle at a corner of another, in place of 1 degenerate triangle"}));
    EXPECT_TRUE(prepared.report.closed && prepared.report.manifold && prepared.report.oriented);
    EXPECT_TRUE(prepared.report.outward);
    EXPECT_FALSE(prepared.report.self_intersecting);
    EXPECT_EQ(prepared.report.triangles, 14u);
    EXPECT_DOUBLE_EQ(prepared.report.volume, 1);
}

TEST(Repair, SeveralCornersOnOneSide) {
    Mesh mesh = box();
    add_corner_on_edge(mesh, 4, 1);
    add_corner_on_edge(mesh, 4, 0); // once more in the half
    add_corner_on_edge(mesh, 4, 0);
    ASSERT_TRUE(prepare_mesh(mesh, {.repair = Repair::as_is}).report.closed);
    const MeshReport report = prepare_mesh(mesh).report;
    EXPECT_TRUE(report.closed && report.manifold && report.outward && !report.self_intersecting);
    EXPECT_DOUBLE_EQ(report.volume, 1);
}

TEST(Repair, ADegenerateTriangleThatNothingCanReplaceStays) {
    // Two corners on a side of the one face, between them one on that of the other: halves on both sides.
    Mesh mesh{"m",
              {{0, 0, 0}, {4, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}, {2, 0, 0}},
              {{0, 2, 1}, {0, 4, 3}, {4, 5, 3}, {5, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 4}, {4, 1, 5}}};
    ASSERT_TRUE(prepare_mesh(mesh, {.repair = Repair::as_is}).report.closed);
    EXPECT_TRUE(prepare_mesh(mesh).report.closed);
    // Each edge of the degenerate one has three others: it cannot be exchanged for halves.
    Mesh pinched{"p", {{0, 0, 0}, {4, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
    constexpr std::array<std::array<std::uint32_t, 2>, 3> sides{{{0, 1}, {0, 2}, {2, 1}}};
    for (const auto& [from, to] : sides) {
        for (int k = 0; k < 3; ++k) {
            const auto apex = static_cast<std::uint32_t>(pinched.vertices.size());
            pinched.vertices.push_back({1.0 * apex, 1.0 * apex * apex, 10 + 1.0 * apex * apex * apex});
            pinched.triangles.push_back({from, to, apex});
        }
    }
    const MeshReport as_is = prepare_mesh(pinched, {.repair = Repair::as_is}).report,
                     repaired = prepare_mesh(pinched).report;
    EXPECT_EQ(repaired.triangles, 10u); // open elsewhere, but not here
    EXPECT_EQ(as_is.triangles, 10u);
}

TEST(Repair, DuplicatesGoOnlyWhereNothingOpens) {
    Mesh doubled = box();
    append(doubled, box());
    ASSERT_TRUE(prepare_mesh(doubled, {.repair = Repair::as_is}).report.closed);
    EXPECT_EQ(prepare_mesh(doubled).report.repairs, std::vector<std::string>{"dropped 12 duplicate triangles"});
    EXPECT_TRUE(prepare_mesh(doubled).report.outward);

    Mesh thrice = doubled;
    append(thrice, box());
    EXPECT_EQ(prepare_mesh(thrice).report.repairs, std::vector<std::string>{"dropped 24 duplicate triangles"});

    // A fin of two equal triangles has an even number at each edge, and is closed so.
    Mesh fin = box();
    fin.vertices.push_back({2, 2, 2});
    fin.triangles.push_back({0, 1, 8});
    fin.triangles.push_back({0, 1, 8});
    ASSERT_TRUE(prepare_mesh(fin, {.repair = Repair::as_is}).report.closed);
    EXPECT_TRUE(prepare_mesh(fin).report.closed);

    // Of an open mesh they go.
    Mesh sheet{"sheet", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}, {1, 2, 0}}};
    EXPECT_EQ(prepare_mesh(sheet).report.repairs, std::vector<std::string>{"dropped 1 duplicate triangle"});
}

TEST(Repair, ManyAtOneEdgeAreNoLongWait) {
    Mesh mesh = box();
    constexpr int many = 50000;
    for (int i = 1; i < many; ++i) {
        mesh.vertices.push_back({static_cast<double>(i) / many, 0, 0});
        mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
    }
    const TimeLimit limit(20);
    EXPECT_EQ(prepare_mesh(mesh).report.file_triangles, many + 11u);
}

/// Closed meshes with all that a repair may drop: the repaired mesh is closed, and as good as the mesh before.
TEST(Repair, NeverOpensAClosedMesh) {
    std::size_t closed = 0, opened_before = 0, split = 0;
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const auto any = [&](std::size_t count) { return static_cast<std::uint32_t>(random() % count); };
        Mesh mesh = seed % 3 == 0 ? box(4) : lattice_torus(5 + any(4), 4 + any(3));
        if (seed % 5 == 0) append(mesh, box(4), {8, 0, 0});
        const std::size_t sound = mesh.triangles.size();
        bool only_corners = true;
        for (int change = 0; change < 1 + static_cast<int>(random() % 8); ++change) {
            switch (any(seed % 2 == 0 ? 1 : 7)) {
            case 0:
            case 1: { // on a triangle that has an area
                add_corner_on_edge(mesh, any(sound), any(3));
                break;
            }
            case 2: // a duplicate
                mesh.triangles.push_back(mesh.triangles[any(mesh.triangles.size())]);
                only_corners = false;
                break;
            case 3: { // the whole surface once more
                const std::size_t count = mesh.triangles.size();
                if (count > 400) break;
                for (std::size_t i = 0; i < count; ++i) mesh.triangles.push_back(mesh.triangles[i]);
                only_corners = false;
                break;
            }
            case 4: { // a degenerate triangle on an edge, once or twice
                const auto t = mesh.triangles[any(sound)];
                const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
                const Vec3 &p = mesh.vertices[t[0]], &q = mesh.vertices[t[1]];
                mesh.vertices.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2});
                for (std::uint32_t i = any(2); i < 2; ++i) mesh.triangles.push_back({t[0], t[1], middle});
                only_corners = false;
                break;
            }
            case 5: { // a fin, once or twice
                const auto t = mesh.triangles[any(sound)];
                mesh.vertices.push_back({9, 9, 9});
                const auto tip = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
                for (std::uint32_t i = any(2); i < 2; ++i) mesh.triangles.push_back({t[0], t[1], tip});
                only_corners = false;
                break;
            }
            default: { // a vertex twice
                const auto v = any(mesh.vertices.size());
                mesh.triangles.push_back({v, any(mesh.vertices.size()), v});
            }
            }
        }
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
        const MeshReport as_is = prepare_mesh(mesh, {.repair = Repair::as_is}).report;
        const PrepareOptions no_holes{.holes = Holes::none};
        const PreparedMesh once = prepare_mesh(mesh, no_holes);
        if (as_is.closed) {
            ++closed;
            EXPECT_TRUE(once.report.closed);
        } else if (once.report.closed) {
            ++opened_before;
        }
        if (only_corners) {
            EXPECT_TRUE(once.report.closed && once.report.outward && !once.report.self_intersecting);
            split += once.report.repairs.size();
        }
        const PreparedMesh twice = prepare_mesh({"m", once.vertices, once.triangles}, no_holes);
        EXPECT_EQ(twice.triangles, once.triangles);
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
        EXPECT_EQ(prepare_mesh(mesh, no_holes).report.closed, once.report.closed);
        if (seed % 16 == 0) Shape::make(once); // can cast and be met, whatever stays
    }
    EXPECT_GT(closed, 200u);
    EXPECT_GT(opened_before, 10u);
    EXPECT_GT(split, 100u);
}

TEST(Prepare, OneTriangleTheOtherWay) {
    Mesh mesh = torus(8, 6, 1, 0.3);
    std::swap(mesh.triangles[7][1], mesh.triangles[7][2]);
    const PreparedMesh prepared = prepare_mesh(mesh);
    EXPECT_EQ(prepared.report.repairs, std::vector<std::string>{"turned 1 triangle to make windings agree"});
    EXPECT_TRUE(prepared.report.outward);
    const MeshReport as_is = prepare_mesh(mesh, {.repair = Repair::as_is}).report;
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
    EXPECT_THROW(prepare_mesh(line, {.repair = Repair::as_is}), InputError);
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
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        const Nesting nesting = static_cast<Nesting>(seed % 3);
        const PreparedMesh once = prepare_mesh(jumble(seed), {.nesting = nesting, .holes = Holes::none});
        EXPECT_FALSE(once.report.repairs.empty());
        const PreparedMesh twice =
            prepare_mesh({once.name, once.vertices, once.triangles}, {.nesting = nesting, .holes = Holes::none});
        EXPECT_EQ(twice.vertices, once.vertices);
        EXPECT_EQ(twice.triangles, once.triangles);
        EXPECT_TRUE(twice.report.repairs.empty());
        EXPECT_EQ(twice.report.volume, once.report.volume);
        EXPECT_TRUE(twice.report.outward || nesting != Nesting::cavities);
    }
}

TEST(Report, NumbersAreInFull) {
    Mesh mesh = box(1.0 / 3);
    for (Vec3& v : mesh.vertices) v.z += 123456.789012345;
    const MeshReport report = prepare_mesh(mesh).report;
    const std::string words = to_text(report);
    const auto read_back = [&](const char* key) {
        return std::stod(words.substr(words.find(key) + 19)); // the column of values
    };
    EXPECT_EQ(read_back("volume "), report.volume);
    EXPECT_EQ(read_back("area "), report.area);
    EXPECT_NE(words.find("123456.789012345 "), std::string::npos) << words;
    EXPECT_NE(words.find(" 0.3333333333333333 0.3333333333333333 "), std::string::npos) << words;
}

TEST(Report, Verdicts) {
    const auto verdict = [](const Mesh& mesh, Repair repair = Repair::allowed) {
        return verdict_of(prepare_mesh(mesh, {.repair = repair, .overlaps = Overlaps::leave}).report);
    };
    EXPECT_TRUE(verdict(box()).good);
    EXPECT_EQ(verdict(box()).text, "good for contacts");
    const auto starts = [](const Verdict& said, const char* words) {
        EXPECT_FALSE(said.good);
        EXPECT_TRUE(said.text.starts_with(words)) << said.text;
        EXPECT_EQ(said.text.find('\n'), std::string::npos);
    };
    Mesh open = box();
    open.triangles.pop_back();
    EXPECT_EQ(verdict(open).text, "good for contacts: a solid, of which 1 hole is spanned");
    open.triangles.pop_back();
    starts(verdict(open), "open: 4 border edges");
    Mesh crossed = box();
    append(crossed, box(), {0.5, 0.5, 0.5});
    starts(verdict(crossed), "self-intersecting: ");
    Mesh large = box(10);
    large.triangles.resize(10);
    append(crossed, large, {5, 0, 0});
    open = crossed;
    starts(verdict(open), "open: 4 border edges");
    EXPECT_TRUE(verdict(open).text.ends_with("; also self-intersecting")) << verdict(open).text;
    Mesh turned = box();
    turn_over(turned);
    starts(verdict(turned, Repair::as_is), "inside out: ");
    std::swap(turned.triangles[3][0], turned.triangles[3][1]);
    starts(verdict(turned, Repair::as_is), "badly wound: ");
    Mesh nested = box(4);
    append(nested, box(), {1, 1, 1});
    starts(verdict(nested), "nested: ");
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
