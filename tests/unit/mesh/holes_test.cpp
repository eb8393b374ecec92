// SPDX-License-Identifier: Apache-2.0
// Holes: what is a solid by its winding number is closed by triangles of our own, a sheet is not.
#include "tests/time_limit.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/collide.h>
#include <raycontact/mass.h>
#include <raycontact/mesh.h>
#include <raycontact/query.h>
#include <raycontact/shape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

using namespace raycontact;
using namespace raycontact::test;

namespace {

double random_unit(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

/// Without some triangles no two of which share a vertex: so each hole is the triangle that was there.
Mesh without_some(Mesh mesh, std::size_t count, std::uint32_t seed, std::vector<std::uint32_t>* left_out = nullptr) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::shuffle(order, random);
    std::set<std::uint32_t> taken, gone;
    for (const std::uint32_t t : order) {
        const auto& triangle = mesh.triangles[t];
        if (gone.size() == count || std::ranges::any_of(triangle, [&](auto v) { return taken.contains(v); })) continue;
        taken.insert(triangle.begin(), triangle.end());
        gone.insert(t);
    }
    std::vector<std::array<std::uint32_t, 3>> kept;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (!gone.contains(t)) kept.push_back(mesh.triangles[t]);
    mesh.triangles = kept;
    if (left_out != nullptr) left_out->assign(gone.begin(), gone.end());
    return mesh;
}

/// Of rings about z, without the cap above a height; radius 1.
Mesh cut_sphere(std::uint32_t around, std::uint32_t rings, std::uint32_t kept) {
    Mesh mesh{"sphere", {{0, 0, -1}}, {}};
    for (std::uint32_t r = 1; r < rings; ++r) {
        const double polar = std::numbers::pi * (1 - double(r) / rings);
        for (std::uint32_t i = 0; i < around; ++i) {
            const double turn = 2 * std::numbers::pi * i / around;
            mesh.vertices.push_back(
                {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)});
        }
    }
    const auto at = [&](std::uint32_t ring, std::uint32_t i) { return 1 + (ring - 1) * around + i % around; };
    for (std::uint32_t i = 0; i < around; ++i) mesh.triangles.push_back({0, at(1, i + 1), at(1, i)});
    for (std::uint32_t r = 1; r + 1 < kept; ++r)
        for (std::uint32_t i = 0; i < around; ++i) {
            mesh.triangles.push_back({at(r, i), at(r, i + 1), at(r + 1, i + 1)});
            mesh.triangles.push_back({at(r, i), at(r + 1, i + 1), at(r + 1, i)});
        }
    return mesh;
}

double height_of(std::uint32_t rings, std::uint32_t ring) {
    return -std::cos(std::numbers::pi * ring / rings);
}

/// As its definition has it (Jacobson et al. 2013), of all triangles.
double winding_number(const Mesh& mesh, const Vec3& p) {
    double sum = 0;
    for (const auto& triangle : mesh.triangles) {
        std::array<std::array<double, 3>, 3> v;
        std::array<double, 3> size;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& at = mesh.vertices[triangle[k]];
            v[k] = {at.x - p.x, at.y - p.y, at.z - p.z};
            size[k] = std::hypot(v[k][0], v[k][1], v[k][2]);
        }
        const auto dot = [&](std::size_t i, std::size_t k) {
            return v[i][0] * v[k][0] + v[i][1] * v[k][1] + v[i][2] * v[k][2];
        };
        const double volume = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1])
                              - v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0])
                              + v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        sum += 2
               * std::atan2(volume, size[0] * size[1] * size[2] + dot(0, 1) * size[2] + dot(1, 2) * size[0]
                                        + dot(2, 0) * size[1]);
    }
    return sum / (4 * std::numbers::pi);
}

TEST(Holes, ASolidWithHolesIsTheSolid) {
    const Mesh whole = torus(40, 20, 1, 0.4, 0.2);
    for (const std::size_t count : {1u, 5u, 30u}) {
        std::vector<std::uint32_t> left_out;
        const Mesh file = without_some(whole, count, 7, &left_out);
        ASSERT_EQ(left_out.size(), count);
        const PreparedMesh mesh = prepare_mesh(file), wanted = prepare_mesh(whole);
        EXPECT_TRUE(mesh.report.closed && mesh.report.oriented && mesh.report.manifold && mesh.report.outward);
        EXPECT_EQ(mesh.report.holes, count);
        EXPECT_EQ(mesh.report.spanning, count);
        EXPECT_EQ(mesh.report.triangles, whole.triangles.size());
        EXPECT_NEAR(mesh.report.volume, wanted.report.volume, 1e-14);
        EXPECT_EQ(mesh.report.repairs.size(), 1 + std::min<std::size_t>(count, 20));
        EXPECT_EQ(mesh.report.repairs[0], "spanned " + std::to_string(count) + (count == 1 ? " hole" : " holes")
                                              + " with " + std::to_string(count)
                                              + (count == 1 ? " triangle" : " triangles") + ", numbered from "
                                              + std::to_string(file.triangles.size()) + " on");
        EXPECT_TRUE(verdict_of(mesh.report).good);
        EXPECT_EQ(prepare_mesh(file, {.holes = Holes::none}).report.border_edges, 3 * count);
    }
}

TEST(Holes, WhatSpansThemIsNumberedAfterTheFile) {
    const Mesh file = without_some(torus(40, 20, 1, 0.4), 12, 3);
    const PreparedMesh mesh = prepare_mesh(file);
    ASSERT_TRUE(std::ranges::is_sorted(mesh.triangle_index));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_EQ(mesh.triangle_index[t], t);
    EXPECT_EQ(mesh.triangles.size(), file.triangles.size() + 12);
}

// A mesh with holes and the mesh that it comes from say the same of points, and of what meets them.
TEST(Holes, QueriesAndContactsAreThoseOfTheSolid) {
    const Mesh whole = torus(48, 24, 1, 0.4, 0.1);
    const Mesh file = without_some(whole, 40, 11);
    const auto solid = Shape::make(whole), holed = Shape::make(file);
    ASSERT_TRUE(holed->has_inside());
    std::mt19937 random(5);
    const auto place = [&](double size) {
        return Vec3{size * (2 * random_unit(random) - 1), size * (2 * random_unit(random) - 1),
                    0.5 * size * (2 * random_unit(random) - 1)};
    };
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = place(1.5);
        EXPECT_EQ(contains(*holed, p), contains(*solid, p));
        EXPECT_DOUBLE_EQ(closest_point(*holed, {}, p)->distance, closest_point(*solid, {}, p)->distance);
    }
    const auto ball = Shape::make(torus(24, 16, 0.3, 0.2));
    std::size_t contacts = 0, on_spans = 0;
    for (int i = 0; i < 60; ++i) {
        const Pose at{.translation = place(1.3)};
        std::multiset<std::array<double, 5>> expected, found;
        for (const auto& [shape, list] : {std::pair{solid.get(), &expected}, std::pair{holed.get(), &found}}) {
            for (const Contact& c : collide(*shape, {}, *ball, at)) {
                list->insert({c.point().x, c.point().y, c.point().z, c.normal.x, c.depth});
                const bool on_face = c.feature.kind == FeatureKind::vertex && c.feature.source == Side::b;
                on_spans += shape == holed.get() && on_face && c.feature.index_a >= file.triangles.size();
            }
        }
        contacts += expected.size();
        EXPECT_EQ(found, expected) << i;
    }
    EXPECT_GT(contacts, 100u);
    EXPECT_GT(on_spans, 0u);
}

TEST(Holes, AFlatHoleIsSpannedFlat) {
    constexpr std::uint32_t around = 24, rings = 16;
    for (const std::uint32_t kept : {13u, 14u, 15u}) {
        const PreparedMesh mesh = prepare_mesh(cut_sphere(around, rings, kept));
        ASSERT_EQ(mesh.report.holes, 1u) << kept;
        EXPECT_TRUE(mesh.report.closed && mesh.report.outward);
        EXPECT_EQ(mesh.report.spanning, around - 2);
        EXPECT_NE(mesh.report.repairs[1].find("spanned a flat hole of 24 edges"), std::string::npos);
        const auto shape = Shape::make(mesh);
        const double top = height_of(rings, kept - 1);
        EXPECT_TRUE(contains(*shape, {0.01, 0.02, top - 1e-9}));
        EXPECT_FALSE(contains(*shape, {0.01, 0.02, top + 1e-9}));
        double area = 0;
        for (std::size_t t = mesh.triangles.size() - mesh.report.spanning; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
            area += 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
        }
        EXPECT_NEAR(area, 0.5 * around * (1 - top * top) * std::sin(2 * std::numbers::pi / around), 1e-12);
    }
}

// A ring of triangles that goes round the tube of a torus is gone: two holes, or one that no plane holds.
TEST(Holes, AHoleThatIsNotFlatHasTheLeastArea) {
    Mesh mesh = torus(32, 16, 1, 0.4);
    std::erase_if(mesh.triangles, [&](const auto& t) { // on top, a quarter of the tube wide
        return std::ranges::all_of(t, [&](std::uint32_t v) {
            const Vec3& p = mesh.vertices[v];
            return p.x > 0.55 && std::fabs(p.y) < 0.5 && p.z > 0.1;
        });
    });
    const MeshReport report = prepare_mesh(mesh).report;
    ASSERT_EQ(report.holes, 1u);
    EXPECT_TRUE(report.closed && report.manifold && report.outward && !report.self_intersecting);
    EXPECT_NE(report.repairs[1].find("spanned a hole of"), std::string::npos);
    EXPECT_GT(report.volume, 0.8 * prepare_mesh(torus(32, 16, 1, 0.4)).report.volume);
}

TEST(Holes, TwoThatMeetInACornerAreTwo) {
    Mesh mesh = torus(32, 16, 1, 0.4);
    const std::uint32_t v = mesh.triangles[100][0];
    std::vector<std::uint32_t> around;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (std::ranges::count(mesh.triangles[t], v) > 0) around.push_back(t);
    ASSERT_EQ(around.size(), 6u);
    // Two that share nothing but the vertex.
    const auto shared = [&](std::uint32_t s, std::uint32_t t) {
        return std::ranges::count_if(mesh.triangles[s],
                                     [&](std::uint32_t u) { return std::ranges::count(mesh.triangles[t], u) > 0; });
    };
    const auto other = std::ranges::find_if(around, [&](std::uint32_t t) { return shared(around[0], t) == 1; });
    ASSERT_NE(other, around.end());
    const double volume = prepare_mesh(mesh).report.volume;
    for (const std::uint32_t t : {std::max(around[0], *other), std::min(around[0], *other)})
        mesh.triangles.erase(mesh.triangles.begin() + t);
    const MeshReport report = prepare_mesh(mesh).report;
    EXPECT_EQ(report.holes, 2u);
    EXPECT_EQ(report.spanning, 2u);
    EXPECT_TRUE(report.manifold && report.outward);
    EXPECT_NEAR(report.volume, volume, 1e-14);
}

// The verdict is what the definition of the winding number says, for ever larger holes.
TEST(Holes, TheWindingNumberSaysWhatIsASolid) {
    constexpr std::uint32_t around = 16, rings = 24;
    std::size_t solids = 0, sheets = 0;
    for (std::uint32_t kept = 3; kept <= rings; ++kept) {
        const Mesh mesh = cut_sphere(around, rings, kept);
        double area = 0, whole = 0;
        for (const auto& [a, b, c] : mesh.triangles) {
            const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
            const Vec3 n{(q.y - p.y) * (r.z - p.z) - (q.z - p.z) * (r.y - p.y),
                         (q.z - p.z) * (r.x - p.x) - (q.x - p.x) * (r.z - p.z),
                         (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)};
            const double twice = std::hypot(n.x, n.y, n.z), into = -1e-6 / twice;
            const Vec3 behind{(p.x + q.x + r.x) / 3 + into * n.x, (p.y + q.y + r.y) / 3 + into * n.y,
                              (p.z + q.z + r.z) / 3 + into * n.z};
            const double number = winding_number(mesh, behind);
            area += twice;
            whole += std::fabs(number - 1) <= 0.15 ? twice : 0;
        }
        const bool solid = prepare_mesh(mesh).report.holes == 1;
        (solid ? solids : sheets) += 1;
        const double share = whole / area;
        if (std::fabs(share - 0.9) < 0.02) continue; // too near to tell from samples
        EXPECT_EQ(solid, share > 0.9) << kept << ' ' << share;
    }
    EXPECT_GT(solids, 3u);
    EXPECT_GT(sheets, 10u);
}

// While the hull was open, nothing seemed to be around its cavity.
TEST(Holes, ACavityStaysOneWhereTheHullHasHoles) {
    Mesh cavity = torus(40, 20, 1, 0.2), whole = torus(40, 20, 1, 0.4);
    turn_over(cavity);
    Mesh mesh = without_some(whole, 6, 8);
    append(mesh, cavity);
    append(whole, cavity);
    const MeshReport report = prepare_mesh(mesh).report;
    EXPECT_EQ(report.holes, 6u);
    EXPECT_TRUE(report.outward);
    EXPECT_NEAR(report.volume, prepare_mesh(whole).report.volume, 1e-13);
}

TEST(Holes, SheetsStaySheets) {
    Mesh open_box = box();
    open_box.triangles.resize(10); // without its top
    Mesh terrain{"terrain", {}, {}};
    for (std::uint32_t i = 0; i < 20; ++i)
        for (std::uint32_t k = 0; k < 20; ++k) terrain.vertices.push_back({double(i), double(k), 0.1 * ((i * k) % 7)});
    for (std::uint32_t i = 0; i + 1 < 20; ++i)
        for (std::uint32_t k = 0; k + 1 < 20; ++k) {
            const std::uint32_t a = 20 * i + k;
            terrain.triangles.push_back({a, a + 20, a + 21});
            terrain.triangles.push_back({a, a + 21, a + 1});
        }
    Mesh room = without_some(torus(24, 12, 1, 0.4), 4, 2); // one looks at its walls from inside
    turn_over(room);
    for (const Mesh& mesh : {open_box, terrain, room, Mesh{"one", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}}) {
        const PreparedMesh sheet = prepare_mesh(mesh);
        EXPECT_EQ(sheet.report.holes, 0u) << mesh.name;
        EXPECT_TRUE(sheet.report.repairs.empty()) << mesh.name;
        EXPECT_EQ(sheet.triangles.size(), mesh.triangles.size());
        EXPECT_FALSE(sheet.report.closed);
        EXPECT_FALSE(Shape::make(sheet)->has_inside());
        EXPECT_EQ(verdict_of(sheet.report).text.substr(0, 6), "open: ");
    }
}

// Walls without thickness: every edge has two triangles, yet nothing is between them.
TEST(Holes, ClosedWallsBackToBackThatHoldNothingAreASheet) {
    for (const std::size_t walls : {2u, 8u, 10u, 12u})
        for (const bool same_diagonals : {true, false}) {
            if (walls == 12 && same_diagonals) continue; // a solid there twice: one goes
            Mesh mesh = box();
            mesh.triangles.resize(walls);
            for (std::size_t i = 0; i < walls; i += 2) {
                // A square is the fan of its first corner; the others' fan has the other diagonal.
                const auto [a, b, c] = mesh.triangles[i];
                const std::uint32_t d = mesh.triangles[i + 1][2];
                ASSERT_EQ(mesh.triangles[i + 1], (std::array<std::uint32_t, 3>{a, c, d}));
                if (same_diagonals)
                    mesh.triangles.insert(mesh.triangles.end(), {{c, b, a}, {d, c, a}});
                else
                    mesh.triangles.insert(mesh.triangles.end(), {{d, b, a}, {d, c, b}});
            }
            const MeshReport report = prepare_mesh(mesh).report;
            EXPECT_TRUE(report.closed && report.oriented) << walls;
            EXPECT_FALSE(report.solid) << walls;
            EXPECT_EQ(kind_of(report), "sheet");
            EXPECT_EQ(report.volume, 0);
            EXPECT_EQ(verdict_of(report).text.substr(0, 8), "hollow: ");
            EXPECT_FALSE(verdict_of(report).good);
            EXPECT_FALSE(Shape::make(mesh)->has_inside());
        }
    EXPECT_TRUE(prepare_mesh(box()).report.solid);
    EXPECT_TRUE(prepare_mesh(box(), {.overlaps = Overlaps::leave}).report.solid);
}

TEST(Holes, OfSheetsThoseThatAreFlatOrSmallAreSpannedOnRequest) {
    Mesh mesh = box();
    mesh.triangles.resize(10);
    const PreparedMesh closed = prepare_mesh(mesh, {.holes = Holes::of_all});
    EXPECT_TRUE(closed.report.closed && closed.report.outward);
    EXPECT_EQ(closed.report.holes, 1u);
    EXPECT_DOUBLE_EQ(closed.report.volume, 1);
    EXPECT_DOUBLE_EQ(closed.report.area, 6);

    // A half pipe: its rim is not flat, and as large as it is.
    Mesh pipe{"pipe", {}, {}};
    for (std::uint32_t i = 0; i <= 8; ++i)
        for (const double z : {0.0, 3.0})
            pipe.vertices.push_back({std::cos(std::numbers::pi * i / 8), std::sin(std::numbers::pi * i / 8), z});
    for (std::uint32_t i = 0; i < 8; ++i) {
        pipe.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        pipe.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    EXPECT_EQ(prepare_mesh(pipe, {.holes = Holes::of_all}).report.holes, 0u);
}

TEST(Holes, AreSpannedAlikeByAnyNumberOfThreads) {
    const Mesh mesh = without_some(torus(200, 100, 1, 0.4, 0.2), 300, 1);
    const PreparedMesh one = prepare_mesh(mesh, {.threads = 1}), many = prepare_mesh(mesh, {.threads = 7});
    EXPECT_EQ(one.report.holes, 300u);
    EXPECT_EQ(one.triangles, many.triangles);
    EXPECT_EQ(one.report.repairs, many.report.repairs);
}

// Corners of one place that a program computed twice.
TEST(Holes, BordersThatDifferInTheLastDigitAreJoined) {
    Mesh mesh = torus(24, 12, 1, 0.4);
    for (Vec3& v : mesh.vertices) v = rounded(v);
    Mesh loose{"loose", {}, {}};
    std::mt19937 random(4);
    for (const auto& t : mesh.triangles) { // every corner has a vertex of its own
        for (const std::uint32_t v : t) {
            Vec3 p = mesh.vertices[v];
            if (random() % 8 == 0) p.z = rounded({0, 0, p.z + 5e-8}).z;
            loose.vertices.push_back(p);
        }
        const auto n = static_cast<std::uint32_t>(loose.vertices.size());
        loose.triangles.push_back({n - 3, n - 2, n - 1});
    }
    const PreparedMesh joined = prepare_mesh(loose);
    EXPECT_TRUE(joined.report.closed && joined.report.manifold && joined.report.outward);
    EXPECT_EQ(joined.report.vertices, mesh.vertices.size());
    EXPECT_EQ(joined.report.holes, 0u);
    ASSERT_EQ(joined.report.repairs.size(), 1u);
    EXPECT_EQ(joined.report.repairs[0].substr(0, 7), "joined ");
    EXPECT_FALSE(prepare_mesh(loose, {.repair = Repair::as_is}).report.closed);
}

TEST(Holes, OfRubbishTakeNoLongerThanItIsMuch) {
    const TimeLimit limit(60);
    std::mt19937 random(9);
    Mesh soup{"soup", {}, {}}, dust{"dust", {}, {}};
    for (std::uint32_t i = 0; i < 3000; ++i)
        soup.vertices.push_back({random_unit(random), random_unit(random), random_unit(random)});
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const auto v = [&] { return static_cast<std::uint32_t>(random() % 3000); };
        soup.triangles.push_back({v(), v(), v()});
        const double x = i % 300, y = double(i / 300);
        const auto n = static_cast<std::uint32_t>(dust.vertices.size());
        for (const Vec3& p : {Vec3{x, y, 0}, Vec3{x + 0.5, y, 0.1}, Vec3{x, y + 0.5, 0.2}}) dust.vertices.push_back(p);
        dust.triangles.push_back({n, n + 1, n + 2});
    }
    EXPECT_FALSE(prepare_mesh(soup, {.check = Check::topology}).report.closed);
    EXPECT_FALSE(prepare_mesh(dust, {.check = Check::topology}).report.closed);
    EXPECT_EQ(prepare_mesh(dust, {.holes = Holes::of_all, .check = Check::topology}).report.holes, 100'000u);
    // One border of 100 000 vertices.
    Mesh fan{"fan", {{0, 0, 0}}, {}};
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const double turn = 2 * std::numbers::pi * i / 100'000;
        fan.vertices.push_back({std::cos(turn), std::sin(turn), 0.3 * std::sin(50 * turn)});
        fan.triangles.push_back({0, i + 1, (i + 1) % 100'000 + 1});
    }
    EXPECT_FALSE(prepare_mesh(fan, {.check = Check::topology}).report.closed);
}

} // namespace
