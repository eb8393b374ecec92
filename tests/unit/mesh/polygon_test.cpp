// SPDX-License-Identifier: Apache-2.0
// A cut is right if its triangles have the polygon's border together and face its way: at each point the number of them
// that cover it is then the winding number of the polygon. Both are checked in whole numbers, and once by counting.
#include "tests/time_limit.h"
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include "mesh/polygon.h"

#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
struct Point {
    std::int64_t x, y;
    auto operator<=>(const Point&) const = default; // NOLINT(modernize-use-nullptr): of clang-tidy 14
};
using Ring = std::vector<Point>;

std::int64_t turn(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

std::int64_t twice_area(const Ring& ring) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) sum += turn({0, 0}, ring[i], ring[(i + 1) % ring.size()]);
    return sum;
}

/// In a slanted plane, exactly.
Vec3 placed(const Point& p, int plane) {
    const auto x = static_cast<double>(p.x), y = static_cast<double>(p.y);
    switch (plane % 4) {
    case 0:
        return {x, y, 7};
    case 1:
        return {y, 3 * x - 2 * y, x};
    case 2:
        return {x - y, 2 * x + y, 5 * y};
    default:
        return {x + y, y, 5 * x + 3 * y};
    }
}

Triangles cut(const Ring& ring, int plane = 0) {
    Mesh mesh;
    std::vector<std::uint32_t> corners(ring.size());
    std::iota(corners.begin(), corners.end(), 0u);
    for (const Point& p : ring) mesh.vertices.push_back(placed(p, plane));
    PolygonCutter cutter;
    cutter.append(mesh, corners);
    cutter.finish(mesh);
    return mesh.triangles;
}

Triangles fan(std::size_t corners) {
    Triangles triangles;
    for (std::uint32_t i = 2; i < corners; ++i) triangles.push_back({0, i - 1, i});
    return triangles;
}

/// Each side of the ring once, and nothing else but sides that meet from both ways.
bool has_border(const Triangles& triangles, std::size_t corners) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    const auto add = [&](std::uint32_t from, std::uint32_t to, int times) {
        sides[std::minmax(from, to)] += from < to ? times : -times;
    };
    for (const auto& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) add(t[k], t[(k + 1) % 3], 1);
    for (std::uint32_t i = 0; i < corners; ++i) add(i, static_cast<std::uint32_t>((i + 1) % corners), -1);
    return std::ranges::all_of(sides, [](const auto& side) { return side.second == 0; });
}

/// `flat` of the triangles have no area; without it any number.
void expect_right(const Ring& ring, const Triangles& triangles, std::optional<std::size_t> flat = 0) {
    ASSERT_EQ(triangles.size(), ring.size() - 2);
    EXPECT_TRUE(has_border(triangles, ring.size()));
    const std::int64_t area = twice_area(ring);
    ASSERT_NE(area, 0);
    std::size_t without = 0;
    std::int64_t sum = 0;
    for (const auto& [a, b, c] : triangles) {
        const std::int64_t part = turn(ring[a], ring[b], ring[c]) * (area > 0 ? 1 : -1);
        EXPECT_GE(part, 0) << a << " " << b << " " << c;
        without += part == 0 ? 1 : 0;
        sum += part;
    }
    EXPECT_EQ(sum, std::abs(area));
    EXPECT_EQ(without, flat.value_or(without));
}

/// In every plane, turned either way, from every corner.
void expect_right_everywhere(const Ring& ring, std::optional<std::size_t> flat = 0) {
    for (const bool back : {false, true}) {
        Ring turned(ring);
        if (back) std::ranges::reverse(turned);
        for (std::size_t start = 0; start < std::min<std::size_t>(ring.size(), 12); ++start) {
            for (int plane = 0; plane < 4; ++plane) {
                SCOPED_TRACE(std::to_string(plane) + " from " + std::to_string(start) + (back ? " back" : ""));
                expect_right(turned, cut(turned, plane), flat);
            }
            std::rotate(turned.begin(), turned.begin() + 1, turned.end());
        }
    }
}

bool cross(const Point& a, const Point& b, const Point& c, const Point& d) {
    const auto sign = [](std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
    const int ab_c = sign(turn(a, b, c)), ab_d = sign(turn(a, b, d)), cd_a = sign(turn(c, d, a)),
              cd_b = sign(turn(c, d, b));
    if (ab_c == 0 && ab_d == 0) { // on one line
        return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
    }
    return ab_c * ab_d <= 0 && cd_a * cd_b <= 0;
}

/// A random polygon whose sides meet at their common corners alone: crossings are undone until none is left.
Ring random_ring(std::mt19937& random, std::size_t corners, std::uint32_t width) {
    for (;;) {
        Ring ring;
        while (ring.size() < corners) {
            const Point p{static_cast<int>(random() % width), static_cast<int>(random() % width)};
            if (std::ranges::find(ring, p) == ring.end()) ring.push_back(p);
        }
        bool crossed = true;
        for (int round = 0; crossed && round < 200; ++round) {
            crossed = false;
            for (std::size_t i = 0; i < corners; ++i) {
                for (std::size_t k = i + 1; k < corners; ++k) {
                    const std::size_t i1 = i + 1, k1 = (k + 1) % corners;
                    const bool next = i1 == k || k1 == i;
                    const Point &common = i1 == k ? ring[k] : ring[i], &one = i1 == k ? ring[i] : ring[i1],
                                &two = i1 == k ? ring[k1] : ring[k];
                    const bool folded =
                        next && turn(one, common, two) == 0
                        && (one.x - common.x) * (two.x - common.x) + (one.y - common.y) * (two.y - common.y) > 0;
                    if (next ? !folded : !cross(ring[i], ring[i1], ring[k], ring[k1])) continue;
                    crossed = true;
                    if (next)
                        std::swap(ring[random() % corners], ring[k]);
                    else
                        std::reverse(ring.begin() + static_cast<std::ptrdiff_t>(i1),
                                     ring.begin() + static_cast<std::ptrdiff_t>(k) + 1);
                }
            }
        }
        if (!crossed && twice_area(ring) != 0) return ring;
    }
}

TEST(Polygon, ConvexOnesAreFansOfTheirFirstCorner) {
    EXPECT_EQ(cut({{0, 0}, {4, 0}, {5, 3}, {1, 4}}), fan(4));
    for (std::size_t corners = 4; corners < 40; ++corners) {
        Ring ring;
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(corners);
            ring.push_back({std::llround(1e6 * std::cos(angle)), std::llround(5e5 * std::sin(angle))});
        }
        for (int plane = 0; plane < 4; ++plane) EXPECT_EQ(cut(ring, plane), fan(corners));
    }
}

TEST(Polygon, ConcaveOnesAreNot) {
    expect_right_everywhere({{0, 0}, {2, 1}, {4, 0}, {2, 4}});                                 // an arrow
    expect_right_everywhere({{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}});                 // an L
    expect_right_everywhere({{0, 0}, {9, 0}, {9, 9}, {6, 9}, {6, 3}, {3, 3}, {3, 9}, {0, 9}}); // a U
    Ring comb{{0, 0}, {200, 0}};
    for (int i = 99; i >= 0; --i) comb.insert(comb.end(), {{2 * i + 1, 100 + i % 7}, {2 * i, 1}});
    expect_right_everywhere(comb);
}

TEST(Polygon, NoSliverWithoutAreaWhereCornersLieOnStraightSides) {
    expect_right_everywhere({{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}});
    expect_right_everywhere({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {2, 2}, {1, 1}}); // all on two lines
    Ring square;
    for (int i = 0; i < 20; ++i) square.push_back({i, 0});
    for (int i = 0; i < 20; ++i) square.push_back({20, i});
    for (int i = 20; i > 0; --i) square.push_back({i, 20});
    for (int i = 20; i > 0; --i) square.push_back({0, i});
    expect_right_everywhere(square);
}

TEST(Polygon, RandomOnes) {
    std::mt19937 random(20131117);
    for (int i = 0; i < 150; ++i) {
        SCOPED_TRACE(i);
        const Ring ring = random_ring(random, 4 + random() % 24, i % 2 == 0 ? 8u : 1000u);
        expect_right_everywhere(ring);
    }
}

/// At the points of a grid that lie on no side, for a ring in 0 to `width`.
void expect_covered(const Ring& ring, const Triangles& triangles, std::int64_t width) {
    const auto sign = twice_area(ring) > 0 ? 1 : -1;
    for (std::int64_t x = 0; x < width; ++x) {
        for (std::int64_t y = 0; y < width; ++y) { // the middle of three
            const Point p{3 * x + 1, 3 * y + 1};
            const auto at = [&](std::size_t i) {
                return Point{3 * ring[i % ring.size()].x, 3 * ring[i % ring.size()].y};
            };
            int winding = 0, covering = 0;
            bool border = false;
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const Point a = at(i), b = at(i + 1);
                const std::int64_t side = turn(a, b, p);
                border = border || side == 0;
                if (a.y <= p.y && b.y > p.y && side > 0) ++winding;
                if (a.y > p.y && b.y <= p.y && side < 0) --winding;
            }
            for (const auto& [a, b, c] : triangles) {
                const std::int64_t ab = sign * turn(at(a), at(b), p), bc = sign * turn(at(b), at(c), p),
                                   ca = sign * turn(at(c), at(a), p);
                border = border || ab == 0 || bc == 0 || ca == 0;
                covering += ab > 0 && bc > 0 && ca > 0 ? 1 : 0;
            }
            if (!border) {
                EXPECT_EQ(covering, sign * winding) << p.x << " " << p.y;
            }
        }
    }
}

/// Triangles of a grid glued together, each to a side of those before: a polygon that winds once around what is in it,
/// but touches itself, at corners and along sides, and around holes.
struct Glued {
    Ring ring;
    std::vector<std::array<std::size_t, 2>> seams; ///< corners at the ends of the sides that are within
};

Glued glued(std::mt19937& random, std::size_t triangles, std::int64_t width) {
    const std::array<Point, 6> ways{{{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}};
    const auto across = [&](const Point& from, const Point& to) { // the third corner of the triangle right of a side
        const Point way{to.x - from.x, to.y - from.y};
        const Point& next = ways[static_cast<std::size_t>(std::ranges::find(ways, way) - ways.begin() + 5) % 6];
        return Point{from.x + next.x, from.y + next.y};
    };
    Glued made{{{width / 2, width / 2}, {width / 2 + 1, width / 2}, {width / 2, width / 2 + 1}}, {}};
    Ring& ring = made.ring;
    std::set<std::array<Point, 3>> used;
    const auto use = [&](std::array<Point, 3> triangle) {
        std::ranges::sort(triangle);
        return used.insert(triangle).second;
    };
    use({ring[0], ring[1], ring[2]});
    for (std::size_t tries = 0; ring.size() < triangles + 2 && tries < 50 * triangles; ++tries) {
        const std::size_t i = random() % ring.size();
        const Point from = ring[i], to = ring[(i + 1) % ring.size()], third = across(from, to);
        if (std::min(third.x, third.y) < 0 || std::max(third.x, third.y) > width || !use({from, to, third})) continue;
        made.seams.push_back({i, (i + 1) % ring.size()});
        ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(i) + 1, third);
        for (auto& seam : made.seams)
            for (std::size_t& end : seam) end += end > i ? 1 : 0;
    }
    return made;
}

/// The same polygon, parted in two where it touches itself at a corner, and joined again by a bridge along a seam.
Ring joined_elsewhere(std::mt19937& random, const Glued& made) {
    const Ring& ring = made.ring;
    for (int tries = 0; tries < 300; ++tries) {
        std::array touch{random() % ring.size(), random() % ring.size()};
        std::ranges::sort(touch);
        const auto [i, k] = touch;
        if (i == k || ring[i] != ring[k] || made.seams.empty()) continue;
        auto [p, q] = made.seams[random() % made.seams.size()];
        const auto is_within = [i = i, k = k](std::size_t at) { return i <= at && at < k; };
        if (is_within(p) == is_within(q)) continue;
        if (!is_within(p)) std::swap(p, q);
        Ring joined;
        for (std::size_t n = 0; n <= k - i; ++n) joined.push_back(ring[i + (p - i + n) % (k - i)]);
        const std::size_t rest = ring.size() - (k - i);
        for (std::size_t n = 0; n <= rest; ++n)
            joined.push_back(ring[(k + ((q + ring.size() - k) % ring.size() + n) % rest) % ring.size()]);
        return joined;
    }
    return ring;
}

/// Without some of the corners that lie on straight sides, so that others touch the sides that are left.
Ring straightened(std::mt19937& random, Ring ring) {
    for (std::size_t i = 0; i < ring.size() && ring.size() > 4; ++i) {
        const Point &before = ring[(i + ring.size() - 1) % ring.size()], &at = ring[i],
                    &after = ring[(i + 1) % ring.size()];
        const bool on = turn(before, at, after) == 0
                        && (before.x - at.x) * (after.x - at.x) + (before.y - at.y) * (after.y - at.y) < 0;
        if (on && random() % 4 != 0) ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i--));
    }
    return ring;
}

TEST(Polygon, EveryPointIsCoveredAsOftenAsThePolygonWindsAroundIt) {
    std::mt19937 random(7);
    const Ring ring = random_ring(random, 30, 60);
    expect_covered(ring, cut(ring, 3), 60);
}

TEST(Polygon, HolesThatTouchTheOutline) {
    const std::vector<Ring> rings{
        // At a corner, seen from a bridge to another corner.
        {{0, 0}, {10, 0}, {10, 10}, {8, 6}, {0, 0}, {6, 8}, {8, 6}, {10, 10}, {0, 10}},
        // At a corner, without a bridge.
        {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}, {6, 8}, {8, 6}},
        // At two corners: what is left are two parts.
        {{0, 0}, {10, 0}, {10, 10}, {6, 4}, {0, 0}, {4, 6}, {10, 10}, {0, 10}},
        // In the middle of a side, seen from a bridge to a corner.
        {{0, 0}, {10, 0}, {10, 10}, {7, 5}, {5, 0}, {3, 5}, {7, 5}, {10, 10}, {0, 10}},
        // Along a part of a side.
        {{0, 0}, {10, 0}, {10, 10}, {7, 5}, {7, 0}, {3, 0}, {3, 5}, {7, 5}, {10, 10}, {0, 10}},
        // Two at one corner.
        {{0, 0},
         {10, 0},
         {10, 10},
         {9, 4},
         {0, 0},
         {9, 6},
         {9, 4},
         {10, 10},
         {6, 9},
         {0, 0},
         {4, 9},
         {6, 9},
         {10, 10},
         {0, 10}},
        // On both sides of a bridge, each with a corner where the other is straight.
        {{6, 3}, {0, 4}, {0, 1}, {6, 2}, {9, 3}, {4, 3}, {4, 2}, {0, 3}},
        // One in the corner of another.
        {{0, 0}, {10, 0}, {10, 10}, {8, 8}, {8, 2}, {2, 2}, {1, 1}, {2, 2}, {2, 8}, {8, 8}, {10, 10}, {0, 10}}};
    for (std::size_t i = 0; i < rings.size(); ++i) {
        SCOPED_TRACE(i);
        expect_right_everywhere(rings[i], {});
        Ring turned(rings[i]);
        for (std::size_t start = 0; start < turned.size(); ++start) {
            expect_covered(turned, cut(turned), 10);
            std::rotate(turned.begin(), turned.begin() + 1, turned.end());
        }
    }
}

/// With its columns and rows apart by 1 to 50.
Ring stretched(std::mt19937& random, Ring ring) {
    for (const auto of : {&Point::x, &Point::y}) {
        std::vector<std::int64_t> places{0};
        while (places.size() < 20) places.push_back(places.back() + (random() % 2 == 0 ? 1 : 1 + random() % 50));
        for (Point& p : ring) p.*of = places[static_cast<std::size_t>(p.*of)];
    }
    return ring;
}

TEST(Polygon, RandomOnesThatTouchThemselves) {
    std::mt19937 random(20131117);
    for (int i = 0; i < 400; ++i) {
        SCOPED_TRACE(i);
        const Glued made = glued(random, 3 + random() % 60, 2 + random() % 8);
        const Ring ring = stretched(random, i % 2 == 0 ? made.ring : joined_elsewhere(random, made));
        expect_right_everywhere(ring, {});
        expect_right_everywhere(straightened(random, ring), {});
    }
}

TEST(Polygon, RepeatedCornersSpikesAndBridgesToHoles) {
    expect_right_everywhere({{0, 0}, {0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 2}, {2, 2}, {2, 6}, {0, 6}}, 3);
    expect_right_everywhere({{0, 0}, {6, 0}, {6, 3}, {9, 3}, {6, 3}, {6, 6}, {0, 6}}, 2); // out and back
    // A square hole, joined to the border by a bridge there and back.
    expect_right_everywhere({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}});
    // Two.
    expect_right_everywhere({{0, 0},
                             {9, 0},
                             {9, 9},
                             {7, 7},
                             {7, 6},
                             {6, 6},
                             {6, 7},
                             {7, 7},
                             {9, 9},
                             {0, 9},
                             {0, 0},
                             {3, 3},
                             {3, 4},
                             {4, 4},
                             {4, 3},
                             {3, 3}});
}

TEST(Polygon, CrossedOrWithoutAreaItStaysAFan) {
    EXPECT_EQ(cut({{0, 0}, {4, 4}, {4, 0}, {0, 4}}), fan(4));
    EXPECT_EQ(cut({{0, 0}, {4, 4}, {4, 0}, {0, 5}}), fan(4));
    EXPECT_EQ(cut({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {1, 1}}), fan(5));
    EXPECT_EQ(cut({{1, 1}, {1, 1}, {1, 1}, {1, 1}}), fan(4));
}

TEST(Polygon, FarOffOneStaysAFanAndIsRefusedLater) {
    Mesh mesh{"m", {{0, 0, 0}, {2e300, 1, 0}, {4, 0, 0}, {2, 4, 0}}, {}};
    PolygonCutter().append(mesh, std::array{0u, 1u, 2u, 3u});
    EXPECT_EQ(mesh.triangles, fan(4));
}

TEST(Polygon, WarpedQuadsAreCutWhereTheyAreNotConcave) {
    Mesh mesh{"m", {{0, 0, 0.1}, {2, 1, -0.1}, {4, 0, 0.2}, {2, 4, 0}}, {}};
    PolygonCutter().append(mesh, std::array{0u, 1u, 2u, 3u});
    EXPECT_EQ(mesh.triangles.size(), 2u);
    for (const auto& t : mesh.triangles) EXPECT_NE(std::ranges::find(t, 1u), t.end());
}

TEST(Polygon, AHundredThousandCornersAreNoLongWait) {
    Ring ring; // a round saw
    constexpr int teeth = 50000;
    for (int i = 0; i < 2 * teeth; ++i) {
        const double angle = 3.141592653589793 * i / teeth, radius = i % 2 == 0 ? 5e8 : 4.9e8;
        ring.push_back({std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle))});
    }
    const TimeLimit limit(60);
    const Triangles triangles = cut(ring);
    ASSERT_EQ(triangles.size(), ring.size() - 2);
    for (const auto& [a, b, c] : triangles) ASSERT_GT(turn(ring[a], ring[b], ring[c]), 0);
    EXPECT_TRUE(has_border(triangles, ring.size()));
    // A comb as thin as its file: each ear reaches along all of it. It ends, one way or the other.
    Ring comb{{0, 0}, {1000000, 0}};
    for (int i = 0; i < teeth; ++i) comb.insert(comb.end(), {{1000000 - 2 * (i % 2), 2 * i + 2}, {1, 2 * i + 3}});
    EXPECT_EQ(cut(comb).size(), comb.size() - 2);
}

/// A prism over a ring in the plane z = 0, one polygon a side, as each format has it.
struct Prism {
    explicit Prism(const Ring& ring) {
        const std::size_t count = ring.size();
        for (const int z : {0, 1})
            for (const Point& p : ring)
                points += text({static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(z)}) + "\n";
        faces.resize(2);
        for (std::size_t i = 0; i < count; ++i) {
            faces[0].push_back(count - 1 - i);
            faces[1].push_back(count + i);
            const std::size_t next = (i + 1) % count;
            faces.push_back({i, next, count + next, count + i});
        }
    }
    std::string obj(bool vertices_last) const {
        std::string vertices, out;
        for (std::size_t from = 0; from < points.size(); from = points.find('\n', from) + 1)
            vertices += "v " + points.substr(from, points.find('\n', from) + 1 - from);
        for (const auto& face : faces) {
            out += "f";
            for (const std::size_t corner : face) out.append(" ").append(std::to_string(corner + 1));
            out += "\n";
        }
        return vertices_last ? out + vertices : vertices + out;
    }
    std::string lists() const {
        std::string out;
        for (const auto& face : faces) {
            out += std::to_string(face.size());
            for (const std::size_t corner : face) out.append(" ").append(std::to_string(corner));
            out += "\n";
        }
        return out;
    }
    std::string counts(const char* between) const {
        return std::to_string(std::ranges::count(points, '\n')) + between + std::to_string(faces.size());
    }
    std::string off() const { return "OFF\n" + counts(" ") + " 0\n" + points + lists(); }
    std::string ply(bool vertices_last) const {
        const std::string coordinates = "property double x\nproperty double y\nproperty double z\n",
                          list = "property list int int vertex_indices\n",
                          vertex =
                              "element vertex " + std::to_string(std::ranges::count(points, '\n')) + "\n" + coordinates,
                          face = "element face " + std::to_string(faces.size()) + "\n" + list;
        return "ply\nformat ascii 1.0\n" + (vertices_last ? face + vertex : vertex + face) + "end_header\n"
               + (vertices_last ? lists() + points : points + lists());
    }

    std::string points;
    std::vector<std::vector<std::size_t>> faces;
};

TEST(Polygon, PrismsOverRandomOnesAreSoundInEveryFormat) {
    const TempFolder folder;
    std::mt19937 random(11);
    for (int i = 0; i < 20; ++i) {
        Ring ring = random_ring(random, 5 + random() % 12, 20);
        if (twice_area(ring) < 0) std::ranges::reverse(ring);
        const Prism prism(ring);
        const std::vector<std::filesystem::path> files{
            folder.write("a.obj", prism.obj(false)), folder.write("b.obj", prism.obj(true)),
            folder.write("a.off", prism.off()), folder.write("a.ply", prism.ply(false)),
            folder.write("b.ply", prism.ply(true))};
        for (const auto& file : files) {
            const Mesh mesh = load_mesh(file);
            EXPECT_EQ(mesh.triangles.size(), 4 * ring.size() - 4);
            const MeshReport report = prepare_mesh(mesh).report;
            EXPECT_TRUE(report.closed && report.manifold && report.oriented && report.outward) << file;
            EXPECT_FALSE(report.self_intersecting) << file;
            EXPECT_TRUE(report.repairs.empty());
            EXPECT_DOUBLE_EQ(report.volume, 0.5 * static_cast<double>(twice_area(ring)));
        }
    }
}

} // namespace
