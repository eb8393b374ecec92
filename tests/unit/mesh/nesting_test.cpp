// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/solids.h"

#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Words = std::vector<std::string>;

/// Boxes in one another, the outermost 10 wide, each wound as told.
Mesh nested(std::initializer_list<bool> outward) {
    Mesh mesh{"nested", {}, {}};
    double inset = 0;
    for (const bool out : outward) {
        append_box(mesh, {inset, inset, inset}, {10 - inset, 10 - inset, 10 - inset}, out);
        inset += 1;
    }
    return mesh;
}

TEST(Nesting, CavityStays) {
    const MeshReport report = prepare_mesh(nested({true, false})).report;
    EXPECT_TRUE(report.repairs.empty());
    EXPECT_TRUE(report.outward);
    EXPECT_EQ(report.components, 2u);
    EXPECT_NEAR(report.volume, 1000 - 512, 1e-9);
}

PreparedMesh prepared(std::initializer_list<bool> outward, Nesting nesting) {
    return prepare_mesh(nested(outward), {.nesting = nesting, .overlaps = Overlaps::leave});
}

TEST(Nesting, PartsInPartsStayAsTheFileHasThem) {
    const MeshReport report = prepared({true, true}, Nesting::as_wound).report;
    EXPECT_TRUE(report.repairs.empty());
    EXPECT_TRUE(report.closed && report.oriented && !report.self_intersecting);
    EXPECT_FALSE(report.outward); // the winding number is 2 in the inner one
    EXPECT_NEAR(report.volume, 1000 + 512, 1e-9);
    EXPECT_NEAR(prepared({true, false, true, true, false}, Nesting::as_wound).report.volume, 1000 - 512 + 216 + 64 - 8,
                1e-9);
}

TEST(Nesting, OnlyOutermostPartsThatAreInsideOutAreTurned) {
    for (const bool inner : {true, false}) {
        const PreparedMesh mesh = prepared({false, inner}, Nesting::as_wound);
        EXPECT_EQ(mesh.report.repairs, Words{"turned 1 component of 2 that wound inward"});
        EXPECT_NEAR(mesh.report.volume, inner ? 1512 : 488, 1e-9);
        const Mesh file = nested({false, inner});
        EXPECT_TRUE(std::equal(mesh.triangles.begin() + 12, mesh.triangles.end(), file.triangles.begin() + 12));
    }
}

TEST(Nesting, CavitiesAreMadeWhenAskedFor) {
    const MeshReport report = prepared({true, true}, Nesting::cavities).report;
    EXPECT_EQ(report.repairs, Words{"turned 1 component of 2 whose winding contradicts its nesting"});
    EXPECT_TRUE(report.outward);
    EXPECT_NEAR(report.volume, 1000 - 512, 1e-9);
    EXPECT_EQ(prepared({false, true}, Nesting::cavities).report.repairs,
              Words{"turned 2 components of 2 whose winding contradicts its nesting"});
}

TEST(Nesting, AlternatesWithDepth) {
    const MeshReport report = prepared({true, false, true, true, false}, Nesting::cavities).report;
    EXPECT_EQ(report.repairs, Words{"turned 2 components of 5 whose winding contradicts its nesting"});
    EXPECT_TRUE(report.outward);
    EXPECT_NEAR(report.volume, 1000 - 512 + 216 - 64 + 8, 1e-9);
}

TEST(Nesting, CavitiesAreUndoneWhenAskedFor) {
    const MeshReport report = prepared({true, false, true, false}, Nesting::solids).report;
    EXPECT_EQ(report.repairs, Words{"turned 2 components of 4 that wound inward"});
    EXPECT_NEAR(report.volume, 1000 + 512 + 216 + 64, 1e-9);
    EXPECT_FALSE(report.outward);
    EXPECT_TRUE(prepared({true, false}, Nesting::as_wound).report.outward);
}

TEST(Nesting, ADegenerateTriangleDoesNotHideThatAPartIsInside) {
    // Its corner reaches furthest: the inner box has one on an edge, on both sides, so that nothing can be split.
    Mesh mesh = nested({true, false});
    for (int k = 0; k < 2; ++k) {
        mesh.vertices.push_back({9, 5.0 + k, 9});
        mesh.triangles.push_back({13, 15, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
    }
    const MeshReport report = prepare_mesh(mesh, {.nesting = Nesting::cavities}).report;
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, 1000 - 512, 1e-9);
}

TEST(Nesting, AsIsChangesNothingAndSaysSo) {
    const Mesh mesh = nested({false});
    const PreparedMesh prepared = prepare_mesh(mesh, {.repair = Repair::as_is});
    EXPECT_EQ(prepared.triangles, mesh.triangles);
    EXPECT_TRUE(prepared.report.closed && prepared.report.oriented);
    EXPECT_FALSE(prepared.report.outward);
    EXPECT_NEAR(prepared.report.volume, -1000, 1e-9);
    EXPECT_FALSE(
        prepare_mesh(nested({true, true}), {.repair = Repair::as_is}).report.outward); // winding number 2 inside
}

TEST(Nesting, OfTooManyShellsInEachOtherTheRestStaysAsWound) {
    const auto prepared = [](int count) {
        return prepare_mesh(shells(count), {.overlaps = Overlaps::leave, .check = Check::topology});
    };
    EXPECT_TRUE(prepared(500).report.repairs.empty());
    const PreparedMesh many = prepared(1000);
    ASSERT_EQ(many.report.repairs.size(), 1u);
    EXPECT_TRUE(many.report.repairs[0].starts_with("left ")
                && many.report.repairs[0].ends_with(
                    " components as wound: too many lie in each other to tell which are cavities"))
        << many.report.repairs[0];
    EXPECT_EQ(many.triangles, shells(1000).triangles);
}

TEST(Nesting, BesideIsNotInside) {
    Mesh mesh = torus(24, 12, 2, 0.5);
    append(mesh, torus(16, 8, 0.5, 0.2)); // in the hole
    Mesh away = torus(16, 8, 0.5, 0.2);
    turn_over(away);
    append(mesh, away, {0, 0, 3});
    const MeshReport report = prepare_mesh(mesh).report;
    EXPECT_EQ(report.repairs, Words{"turned 1 component of 3 that wound inward"});
    EXPECT_TRUE(report.outward);
}

TEST(Nesting, OverlappingSolidsAreNotNested) {
    Mesh mesh = nested({true});
    append_box(mesh, {5, 5, 5}, {12, 8, 8});
    const MeshReport report = prepare_mesh(mesh, {.overlaps = Overlaps::leave}).report;
    EXPECT_TRUE(report.repairs.empty());
    EXPECT_TRUE(report.self_intersecting);
    EXPECT_FALSE(report.outward);
}

TEST(Nesting, FlatTwoSidedSheetIsLeftAlone) {
    const Mesh sheet{"sheet", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
    const MeshReport report = prepare_mesh(sheet).report;
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.repairs.empty());
    EXPECT_TRUE(report.self_intersecting);
    EXPECT_FALSE(report.outward);
}

TEST(Nesting, SlantedTwoSidedSheetsAreLeftAlone) {
    std::mt19937 random(1);
    for (int i = 0; i < 100; ++i) {
        Mesh sheet{"sheet", {}, {{0, 1, 2}, {1, 3, 2}, {2, 1, 0}, {3, 1, 2}}};
        const auto at = [&] { return static_cast<double>(random()) / 1e9; };
        while (sheet.vertices.size() < 4) sheet.vertices.push_back({at(), at(), at()});
        EXPECT_TRUE(prepare_mesh(sheet).report.repairs.empty());
    }
}

TEST(Nesting, TinyPartsFarFromTheMiddleAreTurnedOnlyIfTheyWindInward) {
    for (const bool outward : {true, false}) {
        Mesh mesh{"wide", {}, {}};
        append_box(mesh, {-500, -500, -500}, {-499, -499, -499});
        append_box(mesh, {499, 499, 499}, {500, 500, 500});
        std::mt19937 random(1);
        for (int i = 0; i < 200; ++i) {
            const auto at = [&] { return 200 + 280 * (static_cast<double>(random() >> 8) / 16777216); };
            const Vec3 low{at(), at(), at()};
            append_box(mesh, low, {low.x + 0.0005, low.y + 0.0005, low.z + 0.0005}, outward);
        }
        const MeshReport report = prepare_mesh(mesh).report;
        EXPECT_EQ(report.repairs, outward ? Words{} : Words{"turned 200 components of 202 that wound inward"});
        EXPECT_TRUE(report.outward);
    }
}

TEST(Nesting, ManySolidsInAShell) {
    Mesh mesh = nested({true, false});
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 6; ++k) append_box(mesh, {2.0 + i, 2.0 + k, 3}, {2.7 + i, 2.7 + k, 4}, (i + k) % 2 == 0);
    }
    const MeshReport report = prepare_mesh(mesh, {.nesting = Nesting::cavities}).report;
    EXPECT_EQ(report.repairs, Words{"turned 18 components of 38 whose winding contradicts its nesting"});
    EXPECT_TRUE(report.outward);
    EXPECT_EQ(report.components, 38u);
}

} // namespace
