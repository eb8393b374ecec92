// SPDX-License-Identifier: Apache-2.0
// What a part is split into: solids with their cavities, and sheets.
#include "tests/unit/mesh/solids.h"

#include <raycontact/clash.h>

#include <gtest/gtest.h>

#include <algorithm>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Words = std::vector<std::string>;

AssemblyPart part(Mesh mesh, const std::string& name = "p") {
    return {name, std::make_shared<const Mesh>(std::move(mesh)), {}};
}

std::vector<std::size_t> sizes_of(const Mesh& mesh) {
    std::vector<std::size_t> sizes;
    for (const AssemblyPart& one : split_components({part(mesh)})) sizes.push_back(one.mesh->triangles.size());
    return sizes;
}
using Sizes = std::vector<std::size_t>;

/// Boxes, of a lower and an upper corner each.
Mesh boxes(const std::vector<std::pair<Vec3, Vec3>>& corners) {
    Mesh mesh{"boxes", {}, {}};
    for (const auto& [low, high] : corners) append_box(mesh, low, high);
    return mesh;
}

/// Two triangles, their vertices their own.
void append_sheet(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    append(mesh, {"", {a, b, c, d}, {{0, 1, 2}, {0, 2, 3}}});
}

TEST(Components, SolidsInOneMeshClash) {
    Mesh mesh = boxes({{{0, 0, 0}, {1, 1, 1}}, {{0.5, 0.2, 0.1}, {1.5, 1.2, 1.1}}});
    // In any order, and with vertices of their own for each triangle, as in STL.
    std::ranges::rotate(mesh.triangles, mesh.triangles.begin() + 6);
    Mesh soup{"soup", {}, {}};
    for (const auto& [a, b, c] : mesh.triangles)
        append(soup, {"", {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, {{0, 1, 2}}});
    for (const Mesh& whole : {mesh, soup}) {
        const auto parts = split_components({part(whole, "two.stl")});
        ASSERT_EQ(parts.size(), 2u);
        EXPECT_EQ(parts[0].name, "two.stl #1");
        EXPECT_EQ(parts[1].name, "two.stl #2");
        const auto found = find_clashes(parts).clashes;
        ASSERT_EQ(found.size(), 1u);
        EXPECT_EQ(found[0].kind, ClashKind::overlapping);
        EXPECT_NEAR(found[0].depth.value(), 0.5, 1e-5);
        // The first triangle of the file is of the first; they stay in its order.
        const Mesh& first = *parts[0].mesh;
        EXPECT_EQ(first.vertices[first.triangles[0][0]], whole.vertices[whole.triangles[0][0]]);
        EXPECT_EQ(first.vertices[first.triangles[11][2]], whole.vertices[whole.triangles[23][2]]);
    }
}

TEST(Components, WhatIsClosedByItselfIsOneWhateverItTouches) {
    const Vec3 o{0, 0, 0}, one{1, 1, 1};
    EXPECT_EQ(sizes_of(boxes({{o, one}, {one, {2, 2, 2}}})), (Sizes{12, 12})) << "in a vertex";
    EXPECT_EQ(sizes_of(boxes({{o, one}, {{1, 1, 0}, {2, 2, 1}}})), (Sizes{12, 12})) << "in an edge";
    EXPECT_EQ(sizes_of(boxes({{o, one}, {{1, 0.2, 0.2}, {2, 0.8, 0.8}}})), (Sizes{12, 12})) << "in a part of a face";
    EXPECT_EQ(sizes_of(boxes({{o, one}, {o, {0.5, 0.5, 0.5}}})), (Sizes{12, 12})) << "in a corner of both";
    // Of a face that both have, nothing says to which of them it belongs.
    EXPECT_EQ(sizes_of(boxes({{o, one}, {{1, 0, 0}, {2, 1, 1}}})), Sizes{24});
    // A sheet on an edge of a box; one that divides the box makes two rooms, neither of them closed by itself.
    Mesh fin = boxes({{o, one}}), wall = fin;
    append_sheet(fin, {0, 0, 0}, {0, 0, 1}, {0.5, 0.5, 1}, {0.5, 0.5, 0});
    EXPECT_EQ(sizes_of(fin), (Sizes{12, 2}));
    append_sheet(wall, {0, 0, 0}, {0, 0, 1}, {1, 1, 1}, {1, 1, 0});
    EXPECT_EQ(sizes_of(wall), Sizes{14});
}

TEST(Components, WhatIsOpenHangsTogetherOverVertices) {
    Mesh mesh{"sheets", {}, {}};
    append_sheet(mesh, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    append_sheet(mesh, {5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0});
    append_sheet(mesh, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}); // shares a vertex with the first
    EXPECT_EQ(sizes_of(mesh), (Sizes{4, 2}));
    // Three sheets meet in an edge; one that is cut finer, in T-junctions.
    Mesh tee{"tee", {}, {}};
    append_sheet(tee, {0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0});
    append_sheet(tee, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0});
    append_sheet(tee, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1});
    EXPECT_EQ(sizes_of(tee), Sizes{6});
    Mesh cut{"cut", {}, {}};
    append_sheet(cut, {0, 0, 0}, {1, 0, 0}, {1, 4, 0}, {0, 4, 0});
    append_sheet(cut, {1, 1, 0}, {2, 1, 0}, {2, 3, 0}, {1, 3, 0});
    EXPECT_EQ(sizes_of(cut), Sizes{4});
}

TEST(Components, SolidsWithHolesAreSolids) {
    Mesh mesh = boxes({{{0, 0, 0}, {1, 1, 1}}, {{0.5, 0.2, 0.1}, {1.5, 1.2, 1.1}}});
    mesh.triangles.erase(mesh.triangles.begin() + 15);
    mesh.triangles.erase(mesh.triangles.begin() + 3);
    EXPECT_EQ(sizes_of(mesh), (Sizes{11, 11}));
    const auto found = find_clashes(split_components({part(mesh)})).clashes;
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].depth.value(), 0.5, 1e-5);
    // Sheets beside a solid are no solids.
    Mesh sheets = boxes({{{0, 0, 0}, {4, 4, 4}}});
    append_sheet(sheets, {5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0});
    append_sheet(sheets, {6, 1, 0}, {7, 1, 0}, {7, 2, 0}, {6, 2, 0});
    EXPECT_EQ(sizes_of(sheets), (Sizes{12, 4}));
}

TEST(Components, CavitiesBelongToTheSolidAroundThem) {
    Mesh mesh{"nested", {}, {}};
    append_box(mesh, {6, 6, 6}, {7, 7, 7}, false); // a cavity before its solid
    const auto append_cube = [&](double inset, bool outward) {
        append_box(mesh, {inset, inset, inset}, {10 - inset, 10 - inset, 10 - inset}, outward);
    };
    append_cube(2, true); // in the cavity of the outermost; the one before is a cavity of it
    append_cube(0, true);
    append_cube(1, false);
    append_box(mesh, {4, 4, 4}, {5, 5, 5}); // a solid in a solid: what the file winds so
    const auto parts = split_components({part(mesh)});
    ASSERT_EQ(parts.size(), 3u);
    const auto volume = [&](std::size_t i) { return prepare_mesh(*parts[i].mesh).report.volume; };
    EXPECT_NEAR(volume(0), 216 - 1, 1e-9);
    EXPECT_NEAR(volume(1), 1000 - 512, 1e-9);
    EXPECT_NEAR(volume(2), 1, 1e-9);
    const auto found = find_clashes(parts).clashes;
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].kind, ClashKind::inside) << "what lies in a cavity clashes with nothing";
    EXPECT_EQ(parts[found[0].a].name, "p #1");
    EXPECT_EQ(parts[found[0].b].name, "p #3");
    // Inside out and outermost, each is a solid.
    Mesh apart{"apart", {}, {}};
    append_box(apart, {0, 0, 0}, {1, 1, 1}, false);
    append_box(apart, {0.5, 0.5, 0.5}, {2, 2, 2}, false);
    EXPECT_EQ(sizes_of(apart), (Sizes{12, 12}));
}

TEST(Components, TooManyShellsInEachOtherStayOnePartAndSaySo) {
    Mesh mesh = shells(1000);
    append_box(mesh, {2, 2, 2}, {3, 3, 3});
    Words left_out;
    EXPECT_EQ(split_components({part(mesh)}, &left_out).size(), 1u);
    EXPECT_EQ(left_out, Words{"p: not split: too many of its components lie in each other"});
}

TEST(Components, InstancesFilesAndParents) {
    const auto pair = std::make_shared<const Mesh>(boxes({{{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}}));
    std::vector<AssemblyPart> given;
    given.push_back({"pair", pair, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 5, 0}}, "a.glb"});
    given.push_back(part(box(), "pair #2"));
    given[1].parent = 2;
    given.push_back({"pair", pair, {}, "b.glb", 0});
    const auto parts = split_components(given);
    Words names;
    for (const AssemblyPart& one : parts) names.push_back(one.name);
    EXPECT_EQ(names, (Words{"pair #1", "pair #3", "pair #2", "pair #4", "pair #5"}));
    EXPECT_EQ(parts[0].mesh, parts[3].mesh);
    EXPECT_EQ(parts[1].mesh, parts[4].mesh);
    EXPECT_EQ(parts[1].pose.translation, (Vec3{0, 5, 0}));
    EXPECT_EQ(parts[1].file, "a.glb");
    EXPECT_EQ(parts[1].parent, AssemblyPart::no_part);
    EXPECT_EQ(parts[2].mesh, given[1].mesh);
    EXPECT_EQ(parts[2].parent, 3u);
    EXPECT_EQ(parts[4].parent, 0u);
    EXPECT_EQ(parts[4].file, "b.glb");
}

TEST(Components, FarPartsAreSplitAndRefusedOnesStay) {
    Mesh far = boxes({{{0, 0, 0}, {1000, 1000, 1000}}, {{500, 0, 0}, {1500, 900, 900}}});
    for (Vec3& v : far.vertices) v = {v.x + 691234500, v.y + 5334567250, v.z + 512125}; // in millimetres
    EXPECT_EQ(sizes_of(far), (Sizes{12, 12}));
    Mesh flat{"flat", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
    EXPECT_EQ(sizes_of(flat), Sizes{1});
    // What has no area is in none of several.
    Mesh mesh = boxes({{{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}});
    append(mesh, flat, {0, 7, 0});
    EXPECT_EQ(sizes_of(mesh), (Sizes{12, 12}));
    EXPECT_THROW(split_components({{"none", nullptr, {}}}), InputError);
    EXPECT_TRUE(split_components({}).empty());
}

} // namespace
