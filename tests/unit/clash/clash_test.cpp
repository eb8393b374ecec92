// SPDX-License-Identifier: Apache-2.0
// Boxes, and solids of cubes, whose answers are known by hand; at the origin and at UTM coordinates.
#include "mesh/vector.h"

#include <raycontact/clash.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace raycontact {
namespace {

constexpr double slack = 1e-5; // a hundred perturbations of the edges' rule

/// Of all unit cubes from (0, 0, 0) to (n, n, n) that `fills` has, scaled to `size` metres, moved by `at`.
std::shared_ptr<const Mesh> cubes(int n, const std::function<bool(int x, int y, int z)>& fills, const Vec3& size,
                                  const Vec3& at) {
    auto mesh = std::make_shared<Mesh>();
    const auto filled = [&](const std::array<int, 3>& c) {
        return std::ranges::all_of(c, [&](int k) { return k >= 0 && k < n; }) && fills(c[0], c[1], c[2]);
    };
    for (int i = 0; i < n * n * n; ++i) {
        const std::array<int, 3> cell{i % n, i / n % n, i / n / n};
        if (!filled(cell)) continue;
        for (std::size_t k = 0; k < 3; ++k)
            for (const int side : {0, 1}) {
                std::array<int, 3> other = cell;
                other[k] += side == 0 ? -1 : 1;
                if (filled(other)) continue;
                const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
                for (const auto& [u, v] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
                    std::array<int, 3> corner = cell;
                    corner[k] += side;
                    corner[(k + 1) % 3] += u;
                    corner[(k + 2) % 3] += v;
                    mesh->vertices.push_back(
                        {at.x + size.x * corner[0], at.y + size.y * corner[1], at.z + size.z * corner[2]});
                }
                if (side == 1)
                    mesh->triangles.insert(mesh->triangles.end(),
                                           {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
                else
                    mesh->triangles.insert(mesh->triangles.end(),
                                           {{first, first + 2, first + 1}, {first, first + 3, first + 2}});
            }
    }
    return mesh;
}

AssemblyPart box(const std::string& name, const Vec3& low, const Vec3& high) {
    const Vec3 size{high.x - low.x, high.y - low.y, high.z - low.z};
    return {name,
            cubes(
                1, [](int, int, int) { return true; }, size, low),
            {}};
}

/// A solid of cubes of 1 m.
AssemblyPart solid(const std::string& name, const std::function<bool(int x, int y, int z)>& fills, const Vec3& at = {},
                   double size = 1) {
    return {name, cubes(8, fills, {size, size, size}, at), {}};
}

std::vector<Clash> clashes_of(const std::vector<AssemblyPart>& parts, const ClashOptions& options = {}) {
    return find_clashes(parts, options).clashes;
}

/// Kind of the only clash.
std::string kind_of(const AssemblyPart& a, const AssemblyPart& b) {
    const auto found = clashes_of(std::vector{a, b});
    const auto turned = clashes_of(std::vector{b, a});
    EXPECT_EQ(found.size(), 1u) << a.name << " x " << b.name;
    EXPECT_EQ(turned.size(), 1u) << a.name << " x " << b.name;
    if (found.size() != 1 || turned.size() != 1) return "";
    EXPECT_EQ(found[0].kind, turned[0].kind) << "whichever comes first: " << a.name << " x " << b.name;
    return to_string(found[0].kind);
}

void expect_near(const Vec3& found, const Vec3& expected, double within) {
    EXPECT_NEAR(found.x, expected.x, within);
    EXPECT_NEAR(found.y, expected.y, within);
    EXPECT_NEAR(found.z, expected.z, within);
}

struct Place {
    Vec3 by_vertices, by_pose;
    double unit;
};
// The last one as a file in millimetres has it.
const Place places[] = {{{}, {}, 1},
                        {{691234.5, 5334567.25, 512.125}, {}, 1},
                        {{}, {691234.5, 5334567.25, 512.125}, 1},
                        {{691234500, 5334567250, 512125}, {}, 1000}};

TEST(Clash, KindsOfBoxes) {
    for (const Place& place : places) {
        const double u = place.unit;
        const auto part = [&](const std::string& name, const Vec3& low, const Vec3& high) {
            const Vec3& o = place.by_vertices;
            AssemblyPart made = box(name, {o.x + u * low.x, o.y + u * low.y, o.z + u * low.z},
                                    {o.x + u * high.x, o.y + u * high.y, o.z + u * high.z});
            made.pose.translation = place.by_pose;
            return made;
        };
        const auto here = [&](const Vec3& p) {
            return Vec3{(p.x - place.by_vertices.x - place.by_pose.x) / u,
                        (p.y - place.by_vertices.y - place.by_pose.y) / u,
                        (p.z - place.by_vertices.z - place.by_pose.z) / u};
        };
        const std::vector<AssemblyPart> parts{part("wall", {0, 0, 0}, {1, 4, 4}),
                                              part("pipe", {-1, 1, 1}, {2, 1.5, 1.5}),
                                              part("corner", {0.75, 3.75, 3.75}, {1.25, 4.25, 4.25}),
                                              part("end", {0.5, 0.5, 3}, {2, 1, 3.5}),
                                              part("inside", {0.25, 2, 2}, {0.75, 2.5, 2.5}),
                                              part("flush inside", {0.5, 3.5, 0}, {1, 4, 0.5}),
                                              part("on it", {1, 2, 3}, {1.5, 2.5, 3.5}),
                                              part("off it", {1.125, 2.5, 0.5}, {1.5, 3, 1}),
                                              part("far", {9, 9, 9}, {10, 10, 10}),
                                              part("wall again", {0, 0, 0}, {1, 4, 4})};
        ClashOptions options;
        options.against = {"wall"};
        options.clearance = 0.25 * u;
        options.volumes = true;
        std::set<std::string> seen;
        for (const Clash& c : clashes_of(parts, options)) {
            ASSERT_EQ(c.a, 0u);
            const std::string& name = parts[c.b].name;
            seen.insert(name + ": " + to_string(c.kind));
            ASSERT_TRUE(c.depth);
            EXPECT_EQ(c.box.has_value(), *c.depth > 0) << name;
            const double volume = c.volume.value_or(0) / (u * u * u), depth = *c.depth / u;
            const auto expect_box = [&](const Vec3& low, const Vec3& high) {
                ASSERT_TRUE(c.box);
                expect_near(here(c.box->low), low, slack);
                expect_near(here(c.box->high), high, slack);
            };
            if (name == "pipe") {
                EXPECT_NEAR(volume, 0.25, 1e-9);
                expect_box({0, 1, 1}, {1, 1.5, 1.5});
            } else if (name == "corner") {
                EXPECT_NEAR(depth, 0.25, slack);
                EXPECT_NEAR(volume, 1.0 / 64, 1e-9);
                expect_box({0.75, 3.75, 3.75}, {1, 4, 4});
            } else if (name == "end") {
                EXPECT_NEAR(volume, 0.125, 1e-9);
                expect_box({0.5, 0.5, 3}, {1, 1, 3.5});
            } else if (name == "inside") {
                EXPECT_NEAR(depth, 0.75, 0.5 + slack) << "out through one of the wall's sides";
                expect_box({0.25, 2, 2}, {0.75, 2.5, 2.5});
                EXPECT_NEAR(volume, 0.125, 1e-9);
            } else if (name == "flush inside") {
                expect_box({0.5, 3.5, 0}, {1, 4, 0.5});
            } else if (name == "on it") {
                EXPECT_EQ(depth, 0);
                EXPECT_NEAR(here(c.point).x, 1, slack);
            } else if (name == "off it") {
                EXPECT_EQ(c.distance, 0.125 * u);
                EXPECT_EQ(depth, -0.125);
                EXPECT_EQ(here(c.point_a).x, 1);
                EXPECT_EQ(here(c.point_b).x, 1.125);
                expect_near(c.normal, {1, 0, 0}, 1e-12);
            } else {
                EXPECT_NEAR(volume, 16, 1e-7);
            }
        }
        EXPECT_EQ(seen, (std::set<std::string>{"pipe: piercing", "corner: overlapping", "end: overlapping",
                                               "inside: inside", "flush inside: inside", "on it: touching",
                                               "off it: near", "wall again: duplicate"}));
    }
}

// One part goes through the other if either falls apart: not by the number of curves in which they cross.
TEST(Clash, PiercingPartsFallApart) {
    const auto floor = box("floor", {-5, -5, -1}, {15, 15, 0.5});
    const auto table =
        solid("table", [](int x, int y, int z) { return z == 7 || ((x == 0 || x == 7) && (y == 0 || y == 7)); });
    EXPECT_EQ(kind_of(floor, table), "overlapping") << "four legs stand in it";
    const auto tabletop = box("sheet of a table", {-5, -5, 3}, {15, 15, 3.5});
    EXPECT_EQ(kind_of(tabletop, table), "piercing") << "the legs fall off";

    const auto tube = [](int x, int y, int) { return x < 3 && y < 3 && !(x == 1 && y == 1); };
    EXPECT_EQ(kind_of(box("plate", {-5.1, -5.2, -1}, {15, 15.3, 1.25}), solid("cup", tube)), "overlapping")
        << "a ring in one face, of which the middle is cut off the surface, not off the plate";
    EXPECT_EQ(kind_of(box("plate", {-5.1, -5.2, 1.75}, {15, 15.3, 2.25}), solid("tube", tube)), "piercing");

    const auto bar = box("bar", {-4, 1, 1}, {9, 2, 2});
    EXPECT_EQ(kind_of(bar, box("half lapped", {2, -3, 1.5}, {3, 6, 2.5})), "overlapping");
    EXPECT_EQ(kind_of(bar, box("thinner", {2, -3, 1.25}, {3, 6, 1.75})), "piercing");
    const auto two_walls =
        solid("u", [](int x, int y, int z) { return x == 0 || x == 3 ? z < 6 : x < 3 && y < 8 && z == 0; });
    EXPECT_EQ(kind_of(two_walls, box("pin", {-1, 1.25, 3.25}, {5, 1.5, 3.5})), "piercing") << "through both";
    EXPECT_EQ(kind_of(two_walls, box("pin", {-1, 1.25, 3.25}, {3.5, 1.5, 3.5})), "piercing") << "through one";
    EXPECT_EQ(kind_of(two_walls, box("bridge", {0.5, 1.25, 3.25}, {3.5, 1.5, 3.5})), "overlapping")
        << "its ends are in the walls: what is left of either is in one piece";
    EXPECT_EQ(kind_of(two_walls, box("peg", {0.5, 1.25, 3.25}, {2.5, 1.5, 3.5})), "overlapping");
    // Two solids of one part, one of which is cut.
    const auto pair = solid("two bars", [](int x, int, int z) { return z == 0 && (x == 0 || x == 2); });
    EXPECT_EQ(kind_of(pair, box("through one", {-1, 3.25, -1}, {1.5, 3.5, 2})), "piercing");
    EXPECT_EQ(kind_of(pair, box("into one", {-1, 3.25, 0.5}, {0.5, 3.5, 2})), "overlapping");
}

TEST(Clash, ToleranceWorksOnBothSides) {
    const std::vector<AssemblyPart> parts{box("a", {0, 0, 0}, {1, 1, 1}), box("in", {0.2, 0.2, 0.995}, {0.8, 0.8, 2}),
                                          box("off", {1.005, 0.2, 0.2}, {2, 0.8, 0.8}),
                                          box("deep", {0.2, -1, 0.2}, {0.8, 0.02, 0.8}),
                                          box("far", {-1, 0.2, 0.2}, {-0.02, 0.8, 0.8})};
    ClashOptions options;
    options.against = {"a"};
    EXPECT_EQ(clashes_of(parts, options).size(), 2u);
    options.tolerance = 0.01;
    options.clearance = 0.03;
    const auto found = clashes_of(parts, options);
    ASSERT_EQ(found.size(), 4u);
    EXPECT_EQ(parts[found[0].b].name, "deep");
    EXPECT_EQ(found[0].kind, ClashKind::overlapping);
    EXPECT_NEAR(*found[0].depth, 0.02, 1e-6);
    for (const std::size_t i : {1u, 2u}) {
        EXPECT_EQ(found[i].kind, ClashKind::touching);
        EXPECT_EQ(*found[i].depth, 0);
        EXPECT_FALSE(found[i].box);
    }
    EXPECT_EQ(found[1].distance, 0) << "in";
    EXPECT_NEAR(found[2].distance, 0.005, 1e-12) << "off";
    EXPECT_EQ(found[3].kind, ClashKind::nearby);
    EXPECT_NEAR(found[3].distance, 0.02, 1e-12);
}

TEST(Clash, ClearancesOfSomePairs) {
    std::vector<AssemblyPart> parts;
    for (int i = 0; i < 3; ++i)
        parts.push_back(box("pipe " + std::to_string(i), {1.02 * i, 0, 0}, {1.02 * i + 1, 1, 1}));
    parts.push_back(box("wall", {-0.02 - 0.5, 0, 0}, {-0.02, 1, 1}));
    parts.push_back(box("post", {0, 1.03, 1.04}, {1, 2, 2})); // 0.05 from pipe 0, whose box is nearer in each way
    const auto near = [&](double plain, std::vector<ClearanceOf> some) {
        ClashOptions options;
        options.clearance = plain;
        options.clearances = std::move(some);
        std::set<std::pair<std::size_t, std::size_t>> found;
        const ClashReport report = find_clashes(parts, options);
        for (const Clash& c : report.clashes) {
            EXPECT_EQ(c.kind, ClashKind::nearby);
            found.emplace(c.a, c.b);
        }
        EXPECT_EQ(report.pairs, found.size()) << "boxes that lie along the axes are as far apart as what is in them";
        return found;
    };
    using Pairs = std::set<std::pair<std::size_t, std::size_t>>;
    EXPECT_EQ(near(0, {}), Pairs{});
    EXPECT_EQ(near(0, {{0.03, {"wall", "*"}}}), (Pairs{{0, 3}}));
    EXPECT_EQ(near(0, {{0.03, {"pipe*", "*"}}}), (Pairs{{0, 1}, {1, 2}, {0, 3}}));
    EXPECT_EQ(near(0, {{0.03, {"pipe*", "pipe*"}}}), (Pairs{{0, 1}, {1, 2}}));
    EXPECT_EQ(near(0, {{0.0501, {"post", "pipe 0"}}}), (Pairs{{0, 4}})) << "whichever comes first";
    EXPECT_EQ(near(0, {{0.0499, {"pipe 0", "post"}}}), Pairs{});
    EXPECT_EQ(near(0.03, {{0.01, {"pipe*", "*"}}}), (Pairs{{0, 1}, {1, 2}, {0, 3}})) << "the largest counts";
    EXPECT_EQ(near(0.01, {{0.01, {"*", "*"}}, {0.0501, {"post", "*"}}, {0.02, {"post", "*"}}}), (Pairs{{0, 4}}));
    EXPECT_EQ(near(0.01, {{0.03, {"pipe 0", "wall"}}, {0.03, {"pipe 2", "*"}}}), (Pairs{{0, 3}, {1, 2}}));
    ClashOptions options;
    for (const ClearanceOf& bad : {ClearanceOf{-1, {"*", "*"}}, ClearanceOf{std::nan(""), {"*", "*"}},
                                   ClearanceOf{1, {"pipes", "*"}}, ClearanceOf{1, {"*", "pipe"}}}) {
        options.clearances = {bad};
        EXPECT_THROW(find_clashes(parts, options), InputError);
    }
}

TEST(Clash, OpenPartsAreMarked) {
    AssemblyPart sheet{"sheet", nullptr, {}};
    sheet.mesh = std::make_shared<Mesh>(
        Mesh{"sheet", {{-1, -1, 0.5}, {2, -1, 0.5}, {2, 2, 0.5}, {-1, 2, 0.5}}, {{0, 1, 2}, {0, 2, 3}}});
    const ClashReport report = find_clashes(std::vector{box("a", {0, 0, 0}, {1, 1, 1}), sheet});
    ASSERT_EQ(report.clashes.size(), 1u);
    const Clash& c = report.clashes[0];
    EXPECT_EQ(c.kind, ClashKind::overlapping);
    EXPECT_FALSE(c.open_a);
    EXPECT_TRUE(c.open_b);
    EXPECT_FALSE(c.volume);
    ASSERT_TRUE(c.box) << "about the curve in which they cross";
    expect_near(c.box->low, {0, 0, 0.5}, slack);
    expect_near(c.box->high, {1, 1, 0.5}, slack);
    EXPECT_EQ(report.open, std::vector<std::size_t>{1});
}

TEST(Clash, ToleranceHoldsForOpenPartsWhereTheirDepthIsKnown) {
    const auto sheet = [](const Vec3& o, const Vec3& u, const Vec3& v) {
        auto mesh = std::make_shared<Mesh>();
        for (const auto& [a, b] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
            mesh->vertices.push_back({o.x + a * u.x + b * v.x, o.y + a * u.y + b * v.y, o.z + a * u.z + b * v.z});
        mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
        return AssemblyPart{"sheet", mesh, {}};
    };
    const AssemblyPart floor = sheet({-5, -5, 0}, {10, 0, 0}, {0, 10, 0});
    const AssemblyPart post = box("post", {-0.5, -0.5, -0.001}, {0.5, 0.5, 2});
    const AssemblyPart pipe = box("pipe", {-0.05, -0.05, -3}, {0.05, 0.05, 2});
    const auto kind = [](const AssemblyPart& a, const AssemblyPart& b, double tolerance) {
        ClashOptions options;
        options.tolerance = tolerance;
        const auto found = clashes_of({a, b}, options);
        EXPECT_EQ(found.size(), 1u);
        return found.at(0).kind;
    };
    for (const bool turned : {false, true}) {
        const AssemblyPart &a = turned ? post : floor, &b = turned ? floor : post;
        EXPECT_EQ(kind(a, b, 0.0009), ClashKind::overlapping);
        EXPECT_EQ(kind(a, b, 0.0011), ClashKind::touching);
    }
    // It goes through: no depth says how far. Nor does one of two sheets.
    EXPECT_EQ(kind(floor, pipe, 1), ClashKind::overlapping);
    EXPECT_EQ(kind(floor, sheet({0, -5, -0.001}, {0, 10, 0}, {0, 0, 10}), 1), ClashKind::overlapping);
}

TEST(Clash, SeparationsPartWhatSharesMoreThanPoints) {
    for (const Vec3& off : {Vec3{}, Vec3{691234.5, 5334567.25, 512.125}}) {
        std::vector<AssemblyPart> parts{
            box("a", {0, 0, 0}, {4, 4, 4}),         box("corner", {3.75, 3, 3}, {5, 4.5, 4.5}),
            box("inside", {0.5, 1, 1}, {1, 3, 3}),  box("through", {-1, 1, 3.5}, {5, 2, 3.75}),
            box("again", {0, 0, 0}, {4, 4, 4}),     box("on it", {0, 0, 4}, {1, 1, 5}),
            box("off it", {0, 4.125, 0}, {1, 5, 1})};
        AssemblyPart sheet{"sheet", nullptr, {}};
        sheet.mesh = std::make_shared<Mesh>(
            Mesh{"sheet", {{-1, -1, 0.5}, {5, -1, 0.5}, {5, 5, 0.5}, {-1, 5, 0.5}}, {{0, 1, 2}, {0, 2, 3}}});
        parts.push_back(sheet);
        for (AssemblyPart& part : parts) part.pose.translation = off;
        ClashOptions options;
        options.against = {"a"};
        options.clearance = 0.25;
        for (const Clash& c : clashes_of(parts, options)) EXPECT_FALSE(c.separation) << "nobody asked";
        options.separations = true;
        const std::map<std::string, double> least{{"corner", 0.25}, {"inside", 1}, {"through", 0.5}, {"again", 4}};
        std::size_t parted = 0;
        for (const Clash& c : clashes_of(parts, options)) {
            const std::string& name = parts[c.b].name;
            ASSERT_EQ(c.separation.has_value(), least.contains(name)) << name;
            if (!c.separation) continue;
            ++parted;
            EXPECT_NEAR(c.separation->distance, -least.at(name), 0.01 * least.at(name)) << name;
            const auto shape = [&](std::size_t i) { return Shape::make(prepare_mesh(*parts[i].mesh)); };
            Pose away = parts[c.b].pose;
            away.translation = away.translation - c.separation->distance * c.separation->normal;
            EXPECT_FALSE(intersects(*shape(c.a), parts[c.a].pose, *shape(c.b), away)) << name;
        }
        EXPECT_EQ(parted, least.size());
    }
}

TEST(Clash, PairsAreChosen) {
    std::vector<AssemblyPart> parts;
    for (int i = 0; i < 6; ++i)
        parts.push_back(box("part " + std::to_string(i), {0.75 * i, 0, 0}, {0.75 * i + 1, 1, 1}));
    parts[2].file = "folder/two.obj";
    parts[4].parent = 3;
    const auto pairs = [&](const ClashOptions& options) {
        std::set<std::pair<std::size_t, std::size_t>> found;
        for (const Clash& c : clashes_of(parts, options)) found.emplace(c.a, c.b);
        return found;
    };
    using Pairs = std::set<std::pair<std::size_t, std::size_t>>;
    EXPECT_EQ(pairs({}), (Pairs{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}}));
    EXPECT_EQ(pairs({.against = {"two.obj"}}), (Pairs{{1, 2}, {2, 3}}));
    EXPECT_EQ(pairs({.against = {"folder/*", "part 3"}}), (Pairs{{1, 2}, {3, 4}})) << "not within";
    EXPECT_EQ(pairs({.exclude = {{"part 1", "part ?"}, {"*5", "part 4"}}}), (Pairs{{2, 3}, {3, 4}}));
    EXPECT_EQ(pairs({.exclude_parent_child = true}), (Pairs{{0, 1}, {1, 2}, {2, 3}, {4, 5}}));
    // Paths, and what ends them; a node's name alone is none.
    parts[0].under = {"Building", "Floor 2"};
    parts[1].under = {"Building", "Floor 2", "Pipes"};
    parts[3].under = {"Building", "Floor 12"};
    EXPECT_EQ(path_of(parts[1]), "Building/Floor 2/Pipes/part 1");
    EXPECT_EQ(path_of(parts[5]), "part 5");
    EXPECT_EQ(pairs({.against = {"Floor 2/*"}}), (Pairs{{1, 2}}));
    EXPECT_EQ(pairs({.against = {"Building/*"}}), (Pairs{{1, 2}, {2, 3}, {3, 4}}));
    EXPECT_EQ(pairs({.against = {"Floor*/part 0", "Floor 12/part 3"}}), (Pairs{{0, 1}, {2, 3}, {3, 4}}));
    EXPECT_EQ(pairs({.exclude = {{"Floor 2/*", "Pipes/*"}}}), (Pairs{{1, 2}, {2, 3}, {3, 4}, {4, 5}}));
    for (const ClashOptions& options :
         {ClashOptions{.against = {"Floor 2"}}, ClashOptions{.against = {"loor 2/*"}},
          ClashOptions{.against = {"part 9"}}, ClashOptions{.against = {"*9"}}, ClashOptions{.against = {"*"}},
          ClashOptions{.exclude = {{"part 1", "parts"}}}, ClashOptions{.clearance = -1},
          ClashOptions{.tolerance = std::nan("")}, ClashOptions{.threads = 5000}})
        EXPECT_THROW(find_clashes(parts, options), InputError);
    EXPECT_THROW(find_clashes(std::span(parts).first(1)), InputError);
}

TEST(Clash, GroupsAreOfOnePartOrOfTwoAssemblies) {
    // A flange with four bolts, two of which meet a pipe, which meets a wall.
    std::vector<AssemblyPart> parts{box("pipe", {0, 0, 0}, {1, 1, 1}), box("flange", {4, 0, 0}, {8, 1, 1}),
                                    box("wall", {-1, 0, 0}, {0.2, 1, 1})};
    for (int i = 0; i < 4; ++i)
        parts.push_back(
            box("bolt " + std::to_string(i), {i < 2 ? 0.9 : 3 + i, 0.2 * i, 0.2}, {4.01 + i, 0.2 * i + 0.1, 2}));
    for (std::size_t i = 3; i < 7; ++i) parts[i].under = {"hall", "joint", "bolts"};
    parts[1].under = {"hall", "joint"};
    parts[0].under = {"hall"};
    const std::vector<Clash> clashes = clashes_of(parts);
    ASSERT_EQ(clashes.size(), 7u);
    const auto members = [&](const ClashGroup& group) {
        std::set<std::set<std::string>> found;
        for (const std::size_t i : group.clashes) {
            found.insert({parts[clashes[i].a].name, parts[clashes[i].b].name});
            const AxisBox box = clashes[i].box.value();
            EXPECT_EQ(least(group.box.low, box.low), group.box.low);
            EXPECT_EQ(most(group.box.high, box.high), group.box.high);
        }
        EXPECT_TRUE(std::ranges::is_sorted(group.clashes));
        return found;
    };
    const auto named = [&](const std::vector<ClashGroup>& groups) {
        std::map<std::pair<std::string, std::string>, std::size_t> found;
        std::size_t all = 0;
        for (std::size_t i = 0; i < groups.size(); ++i) {
            found[{groups[i].a, groups[i].b}] = members(groups[i]).size();
            all += groups[i].clashes.size();
            if (i > 0) {
                EXPECT_LT(groups[i - 1].clashes[0], groups[i].clashes[0]);
            }
        }
        EXPECT_EQ(all, clashes.size()) << "each once";
        return found;
    };
    using Groups = std::map<std::pair<std::string, std::string>, std::size_t>;
    EXPECT_EQ(named(group_by_part(parts, clashes)), (Groups{{{"hall/joint/flange", ""}, 4}, {{"hall/pipe", ""}, 3}}));
    EXPECT_EQ(
        named(group_by_assembly(parts, clashes)),
        (Groups{{{"hall/joint", "hall/joint/bolts"}, 4}, {{"hall", "hall/joint/bolts"}, 2}, {{"hall", "wall"}, 1}}));
    EXPECT_EQ(named(group_by_assembly(parts, clashes, 1)), (Groups{{{"hall", "hall"}, 6}, {{"hall", "wall"}, 1}}));
    EXPECT_EQ(
        named(group_by_assembly(parts, clashes, 2)),
        (Groups{{{"hall/joint", "hall/joint"}, 4}, {{"hall/joint", "hall/pipe"}, 2}, {{"hall/pipe", "wall"}, 1}}));
    // Of some of them; the last one of two parts names both.
    const std::vector<Clash> one{clashes[0]};
    const auto alone = group_by_part(parts, one);
    ASSERT_EQ(alone.size(), 1u);
    EXPECT_EQ(alone[0].a, path_of(parts[one[0].a]));
    EXPECT_EQ(alone[0].b, path_of(parts[one[0].b]));
    EXPECT_TRUE(group_by_part(parts, {}).empty());
    EXPECT_THROW(group_by_part(std::span(parts).first(2), clashes), InputError);
    EXPECT_THROW(group_by_assembly(std::span(parts).first(2), clashes), InputError);
}

TEST(Clash, ProgressIsToldAndASearchCanBeStopped) {
    const std::vector<AssemblyPart> parts{box("a", {0, 0, 0}, {1, 1, 1}), box("b", {0.5, 0, 0}, {1.5, 1, 1})};
    std::vector<double> told;
    ClashOptions options;
    options.progress = [&](double done) { told.push_back(done); };
    EXPECT_EQ(clashes_of(parts, options).size(), 1u);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_EQ(told.back(), 1);
    options.stop = [] { return true; };
    EXPECT_TRUE(clashes_of(parts, options).empty());
}

/// A door of 1 m about a hinge at the origin, between a frame that it leaves free and a wall.
std::vector<AssemblyPart> door_and_walls(const Vec3& off) {
    const auto at = [&](double x, double y, double z) { return Vec3{off.x + x, off.y + y, off.z + z}; };
    return {box("door", at(0.1, -0.02, 0), at(1, 0.02, 2)), box("handle", at(0.9, -0.1, 0.9), at(0.95, -0.02, 1)),
            box("wall", at(-0.5, 0.5, 0), at(0.3, 0.6, 2)), box("far wall", at(-3, -3, 0), at(-2, 3, 2)),
            box("post", at(0.2, -0.9, 0), at(0.3, -0.8, 2))};
}
std::vector<Pose> turns(const Vec3& point, double from, double to) {
    std::vector<Pose> moves;
    for (const double angle : {from, 0.5 * (from + to), to}) {
        Pose move = pose_from_quaternion({}, std::cos(angle / 2), 0, 0, std::sin(angle / 2));
        const Vec3 moved = transform_point(move, point);
        move.translation = {point.x - moved.x, point.y - moved.y, point.z - moved.z};
        moves.push_back(move);
    }
    return moves;
}

TEST(ClashOnAPath, FindsWhatMovingPartsMeetAndHowNearTheyCome) {
    for (const Vec3& off : {Vec3{}, Vec3{500000, 6000000, 100}}) {
        const auto parts = door_and_walls(off);
        // Open by 120 degrees: the far lower edge of the wall is met by the door's face at its nearer corner.
        const PathClashReport open = find_path_clashes(parts, {"door", "handle"}, turns(off, 0, 2.0944));
        ASSERT_EQ(open.clashes.size(), 1u);
        EXPECT_EQ(parts[open.clashes[0].moving].name, "door");
        EXPECT_EQ(parts[open.clashes[0].other].name, "wall");
        EXPECT_TRUE(open.clashes[0].meet);
        const double met = std::atan2(0.5, 0.3) - std::asin(0.02 / std::hypot(0.5, 0.3));
        EXPECT_NEAR(open.clashes[0].place.time, 2 * met / 2.0944, 1e-5);
        EXPECT_LE(open.clashes[0].place.time, 2 * met / 2.0944 + 1e-9);
        // What comes nearest of the others: the handle to the far wall, at the end.
        ASSERT_TRUE(open.nearest);
        EXPECT_FALSE(open.nearest->meet);
        // The other way the handle hits the post; the door comes near it.
        const PathClashReport back = find_path_clashes(parts, {"door", "handle"}, turns(off, 0, -1.0), {});
        ASSERT_EQ(back.clashes.size(), 0u);
        ASSERT_TRUE(back.nearest);
        EXPECT_EQ(parts[back.nearest->other].name, "post");
        EXPECT_NEAR(back.nearest->place.time, 2, 1e-3);
        ClashOptions near;
        near.clearance = back.nearest->place.distance + 1e-3;
        const PathClashReport within = find_path_clashes(parts, {"*o*r", "handle"}, turns(off, 0, -1.0), near);
        ASSERT_FALSE(within.clashes.empty());
        EXPECT_FALSE(within.clashes[0].meet);
        EXPECT_NEAR(within.clashes[0].place.distance, back.nearest->place.distance, 1e-3);
        // A clearance of others does not count, one of these two does.
        near.clearance = 0;
        near.clearances = {{100, {"door", "handle"}}, {100, {"*wall", "door"}}};
        const PathClashReport some = find_path_clashes(parts, {"door", "handle"}, turns(off, 0, -1.0), near);
        ASSERT_EQ(some.clashes.size(), 2u);
        for (const PathClash& clash : some.clashes) EXPECT_TRUE(parts[clash.other].name.ends_with("wall"));
        EXPECT_EQ(parts[some.nearest->other].name, "post");
        // What is left out is not asked.
        ClashOptions without;
        without.exclude = {{"door", "wall"}};
        EXPECT_TRUE(find_path_clashes(parts, {"door", "handle"}, turns(off, 0, 1.2), without).clashes.empty());
    }
}

TEST(ClashOnAPath, RefusesWhatIsNotSound) {
    const auto parts = door_and_walls({});
    const auto moves = turns({}, 0, 1);
    EXPECT_THROW(find_path_clashes(parts, {"window"}, moves), InputError);
    EXPECT_THROW(find_path_clashes(parts, {"*"}, moves), InputError);
    EXPECT_THROW(find_path_clashes(parts, {}, moves), InputError);
    EXPECT_THROW(find_path_clashes(parts, {"door"}, {}), InputError);
    std::vector<Pose> skewed = moves;
    skewed[1].rotation[1] += 0.1;
    EXPECT_THROW(find_path_clashes(parts, {"door"}, skewed), InputError);
    EXPECT_THROW(find_path_clashes(parts, {"door"}, moves, {.clearance = -1}), InputError);
    EXPECT_THROW(find_path_clashes(std::span(parts).first(1), {"door"}, moves), InputError);
}

} // namespace
} // namespace raycontact
