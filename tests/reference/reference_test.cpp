// SPDX-License-Identifier: Apache-2.0
// The reference itself, on cases whose answer is known by hand.
#include "reference/compare.h"
#include "reference/contacts.h"
#include "reference/edges.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "reference/ray.h"
#include "reference/side.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Solid solid(const Mesh& mesh) {
    return make_solid(mesh.name, mesh.vertices, mesh.triangles);
}

std::uint32_t vertex_at(const Solid& s, const Vec3& p) {
    for (std::uint32_t v = 0; v < s.vertices.size(); ++v)
        if (s.vertices[v] == p) return v;
    ADD_FAILURE() << "no vertex at " << p.x << " " << p.y << " " << p.z;
    return 0;
}

Pose at(double x, double y, double z) {
    Pose pose;
    pose.translation = {x, y, z};
    return pose;
}

// Volume by the divergence theorem: positive when outward.
double volume(const Solid& s) {
    double six = 0;
    for (const auto& t : s.triangles) six += dot(s.vertices[t[0]], cross(s.vertices[t[1]], s.vertices[t[2]]));
    return six / 6;
}

TEST(reference_meshes, are_what_they_say) {
    EXPECT_DOUBLE_EQ(volume(solid(box_mesh({1, 2, 3}))), 48);
    EXPECT_DOUBLE_EQ(volume(solid(grid_box_mesh(4))), 1);
    EXPECT_DOUBLE_EQ(volume(solid(l_prism_mesh())), 0.375);
    EXPECT_DOUBLE_EQ(volume(solid(frame_mesh())), 0.25 * (1.5 * 1.5 - 0.75 * 0.75));
    EXPECT_GT(volume(solid(tetrahedron_mesh())), 0.1);
    EXPECT_GT(volume(solid(bumpy_octahedron_mesh(10))), 1);
    EXPECT_EQ(bumpy_octahedron_mesh(10).triangles.size(), 800u);
    for (const Mesh& m : {box_mesh({1, 1, 1}), grid_box_mesh(4), tetrahedron_mesh(), l_prism_mesh(), frame_mesh(),
                          bumpy_octahedron_mesh(7)})
        EXPECT_TRUE(solid(m).closed) << m.name;
    EXPECT_FALSE(solid(bowl_mesh(4)).closed);
    EXPECT_FALSE(solid(sheet_mesh(4)).closed);
}

TEST(reference_normals, of_a_box_point_along_its_diagonals) {
    const Solid box = solid(box_mesh({1, 1, 1}));
    for (std::size_t v = 0; v < box.vertices.size();
         ++v) // whatever the split of the faces: angles, not triangles, count
        EXPECT_LT(length(box.vertex_normals[v] - unit(box.vertices[v])), 1e-15);
}

TEST(reference_exits, of_a_cube_are_its_diagonal) {
    for (const double exit : solid(box_mesh({1, 1, 1})).exits) EXPECT_NEAR(exit, 2 * std::sqrt(3.0), 1e-14);
}

TEST(reference_exits, of_the_l_prism) {
    const Solid prism = solid(l_prism_mesh());
    // The reflex corner: three face angles (90, 90 and 270 degrees) sum to (1, 1, -+3) x 90 degrees; inward goes down
    // and into the L, leaving by the far cap at height 0.5.
    const std::uint32_t reflex = vertex_at(prism, {0.5, 0.5, 0.5});
    const Vec3 n = unit({1, 1, 3});
    EXPECT_LT(length(prism.vertex_normals[reflex] - n), 1e-15);
    EXPECT_NEAR(prism.exits[reflex], 0.5 / n.z, 1e-14);
    // An outer corner of the L: inward along (1, 1, -1), through the notch only after leaving by the cap at 0.5.
    const std::uint32_t corner = vertex_at(prism, {0, 0, 0.5});
    EXPECT_NEAR(prism.exits[corner], 0.5 * std::sqrt(3.0), 1e-14);
}

TEST(reference_exits, are_infinite_where_nothing_is_met_from_inside) {
    for (const double exit : solid(sheet_mesh(1)).exits) EXPECT_EQ(exit, infinity);
    EXPECT_EQ(solid(sheet_mesh(1)).reach, solid(sheet_mesh(1)).diagonal);
}

TEST(reference_exits, are_zero_where_the_inward_normal_points_out) {
    // Where the angle-weighted normal leaves the cone of its own triangles, the winding number just beside the apex
    // says so too.
    Random random(7);
    int out = 0;
    int in = 0;
    for (int k = 0; k < 4000; ++k) {
        const Solid s = solid(crooked_pyramid_mesh(random));
        if (s.exit_margins[0] < 1e-3) continue;
        const double inside = winding_number(s, -1e-5 * s.vertex_normals[0]);
        EXPECT_NEAR(inside, s.exits[0] > 0 ? 1 : 0, 1e-6);
        (inside > 0.5 ? in : out) += 1;
    }
    std::printf("[ counts   ] inward normals: %d go in, %d point out at once\n", in, out);
    EXPECT_GT(in, 1000);
    EXPECT_GT(out, 3);
}

TEST(reference_contacts, of_a_box_corner_in_a_box) {
    const Solid big = solid(box_mesh({1, 1, 1}));
    const Solid small = solid(box_mesh({0.5, 0.5, 0.5}));
    // The corner (-.5, -.5, -.5) of the small box lies 0.125 below the top of the big one; it looks up along (1, 1, 1)
    // and leaves by the top 0.125 sqrt(3) further. Its three fellows on that face likewise.
    const auto contacts = find_contacts(big, at(0, 0, 0), small, at(0.125, 0.0625, 1.375));
    ASSERT_EQ(contacts.size(), 4u);
    for (const auto& c : contacts) {
        EXPECT_EQ(c.vertex_body, Side::b);
        EXPECT_NEAR(c.depth, 0.125, 1e-14);
        EXPECT_NEAR(c.ray_length, 0.125 * std::sqrt(3.0), 1e-14);
        EXPECT_LT(length(c.normal - Vec3{0, 0, 1}), 1e-15); // A (below) to B (above)
        EXPECT_NEAR(c.point.z, 0.875, 1e-15);
        EXPECT_EQ(big.face_normals[c.triangle], (Vec3{0, 0, 1}));
    }
}

TEST(reference_contacts, of_a_box_corner_along_the_ray) {
    const Solid big = solid(box_mesh({1, 1, 1}));
    const Solid small = solid(box_mesh({0.5, 0.5, 0.5}));
    for (const Direction direction : {Direction::ray, Direction::weighted}) {
        const auto contacts = find_contacts(big, at(0, 0, 0), small, at(0.125, 0.0625, 1.375), direction);
        ASSERT_EQ(contacts.size(), 4u);
        for (const auto& c : contacts) {
            EXPECT_NEAR(c.depth, c.ray_length, 1e-14);
            EXPECT_LT(length(c.normal + unit(small.vertices[c.vertex])), 1e-15); // A (below) to B (above)
            const auto triangles = std::count_if(small.triangles.begin(), small.triangles.end(), [&](const auto& t) {
                return std::find(t.begin(), t.end(), c.vertex) != t.end();
            });
            // Half a square metre each, of which a corner has a third.
            EXPECT_NEAR(c.weight, direction == Direction::weighted ? double(triangles) / 6 : 1, 1e-14);
        }
    }
}

TEST(reference_contacts, swap_flips_normals) {
    const Solid big = solid(box_mesh({1, 1, 1}));
    const Solid small = solid(box_mesh({0.5, 0.5, 0.5}));
    const auto one = find_contacts(big, at(0, 0, 0), small, at(0.125, 0.0625, 1.375));
    const auto two = find_contacts(small, at(0.125, 0.0625, 1.375), big, at(0, 0, 0));
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(two[i].vertex_body, Side::a);
        EXPECT_EQ(one[i].normal, -two[i].normal);
        EXPECT_EQ(one[i].depth, two[i].depth);
    }
}

TEST(reference_contacts, of_a_box_inside_a_box_stop_at_the_exit) {
    // Wholly inside: each ray leaves the small box through its far corner before it meets the big one.
    const auto contacts =
        find_contacts(solid(box_mesh({1, 1, 1})), at(0, 0, 0), solid(box_mesh({0.25, 0.25, 0.25})), at(0, 0, 0));
    EXPECT_TRUE(contacts.empty());
}

TEST(reference_contacts, of_a_tetrahedron_standing_in_a_slab) {
    // The slab is entered by the apex alone, 0.1 m deep; depth is measured along the slab's normal.
    Solid tip = solid(tetrahedron_mesh());
    const Solid slab = solid(box_mesh({5, 5, 0.5}));
    Pose turned; // upside down: apex at z = -0.875
    turned.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    turned.translation = {0, 0, 0.5 - 0.1 + 0.875};
    const auto contacts = find_contacts(slab, {}, tip, turned);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_EQ(contacts[0].vertex, 3u);
    EXPECT_NEAR(contacts[0].depth, 0.1, 1e-14);
    EXPECT_LT(length(contacts[0].normal - Vec3{0, 0, 1}), 1e-15);
    EXPECT_GT(contacts[0].ray_length, contacts[0].depth);
}

TEST(reference_contacts, do_not_see_the_notch_of_the_l) {
    // A small box wholly in the notch of the L: inside its bounds, outside its solid. Rays are cast, none counts.
    const Solid prism = solid(l_prism_mesh());
    const Solid small = solid(box_mesh({0.125, 0.125, 0.125}));
    EXPECT_EQ(cast_all(small, at(0.75, 0.75, 0.25), prism, {}).size(), 8u);
    EXPECT_TRUE(find_contacts(prism, {}, small, at(0.75, 0.75, 0.25)).empty());
    // Pushed 1/16 into the wall x = 0.5 of the notch: four corners look along +x and leave by it.
    const auto contacts = find_contacts(prism, {}, small, at(0.5625, 0.78125, 0.25));
    ASSERT_EQ(contacts.size(), 4u);
    for (const auto& c : contacts) {
        EXPECT_NEAR(c.depth, 0.0625, 1e-14);
        EXPECT_LT(length(c.normal - Vec3{1, 0, 0}), 1e-15);
    }
}

TEST(reference_contacts, of_an_open_target_reach_beyond_its_box) {
    // A flat sheet facing up, a box pushed through it from above: its lower corners lie below the sheet's flat box.
    Mesh flat = sheet_mesh(1);
    for (Vec3& v : flat.vertices) v.z = 0;
    const Solid sheet = solid(flat);
    const Solid box = solid(box_mesh({0.25, 0.25, 0.25}));
    const auto contacts = find_contacts(sheet, {}, box, at(0.0625, 0, 0.125));
    ASSERT_EQ(contacts.size(), 4u);
    for (const auto& c : contacts) {
        EXPECT_EQ(c.vertex_body, Side::b);
        EXPECT_NEAR(c.depth, 0.125, 1e-14);
        EXPECT_LT(length(c.normal - Vec3{0, 0, 1}), 1e-15);
    }
}

TEST(reference_edges, of_crossed_bars) {
    // No vertex is inside: a bar along x on one along y, 1/64 deep. Each of two edges of the one passes each of two of
    // the other.
    const Solid low = solid(box_mesh({1, 0.125, 0.125})), high = solid(box_mesh({0.125, 1, 0.125}));
    const Pose pose = at(0.01, 0.02, 0.25 - 1.0 / 64);
    EXPECT_TRUE(find_contacts(low, {}, high, pose).empty());
    for (const bool turned : {false, true}) {
        const auto contacts = turned ? find_edges(high, pose, low, {}) : find_edges(low, {}, high, pose);
        ASSERT_EQ(contacts.size(), 4u);
        for (const auto& c : contacts) {
            EXPECT_EQ(c.kind, FeatureKind::edges);
            EXPECT_EQ(c.vertex_body, Side::a);
            EXPECT_NEAR(c.depth, 1.0 / 64, 1e-6);
            EXPECT_LT(length(c.normal - Vec3{0, 0, turned ? -1.0 : 1.0}), 1e-6);
            EXPECT_NEAR(c.point.z, turned ? 0.125 - 1.0 / 64 : 0.125, 1e-6); // a's
            EXPECT_NEAR(std::fabs(c.point.x - 0.01), 0.125, 1e-6);
            EXPECT_NEAR(std::fabs(c.point.y), 0.125, 1e-6);
        }
    }
}

// Two corners that overlap, as edges-loop.svg of the page has it: a loop, two places where edges pass each other, and
// each corner is a vertex in contact.
TEST(reference_edges, of_two_corners) {
    const Solid box = solid(box_mesh({0.5, 0.5, 0.5}));
    const Pose pose = at(0.9, 0.85, 0.8);
    EXPECT_EQ(find_contacts(box, {}, box, pose).size(), 2u);
    for (const auto& c : find_edges(box, {}, box, pose)) {
        EXPECT_EQ(c.kind, FeatureKind::edges);
        EXPECT_NEAR(std::fabs(c.normal.x) + std::fabs(c.normal.y) + std::fabs(c.normal.z), 1, 1e-6);
        EXPECT_GT(c.depth, 0.05 - 1e-6);
        EXPECT_LT(c.depth, 0.2 + 1e-6);
    }
}

// Parallel edges of flush boxes have no normal of their own: a face's serves.
TEST(reference_edges, of_flush_boxes) {
    const Solid box = solid(box_mesh({0.5, 0.5, 0.5}));
    const auto contacts = find_edges(box, {}, box, at(0, 0, 0.98));
    ASSERT_GE(contacts.size(), 4u);
    for (const auto& c : contacts) {
        EXPECT_NEAR(c.depth, 0.02, 1e-6);
        EXPECT_LT(length(c.normal - Vec3{0, 0, 1}), 1e-6);
    }
}

// The loops on both sides of a plate cancel: one of the two exits, and no contact the other way.
TEST(reference_edges, of_a_bar_through_a_plate) {
    const Solid plate = solid(box_mesh({1, 1, 0.0625})), bar = solid(box_mesh({0.125, 0.25, 1}));
    const auto contacts = find_edges(plate, {}, bar, at(0.01, 0.02, 0.03));
    ASSERT_GE(contacts.size(), 4u);
    for (const auto& c : contacts) {
        EXPECT_NEAR(c.depth, 0.125, 1e-3);
        EXPECT_LT(length(c.normal - contacts[0].normal), 1e-6);
        EXPECT_NEAR(std::fabs(c.normal.z), 1, 1e-6);
    }
}

// Round rods that cross: the middle of a facet's edge is deeper than its ends, on the border.
TEST(reference_edges, of_crossed_rods) {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    constexpr std::uint32_t sides = 32;
    for (std::uint32_t i = 0; i < sides; ++i)
        for (const double x : {-2.0, 2.0}) {
            const double turn = 2 * std::numbers::pi * i / sides;
            vertices.push_back({x, std::cos(turn), std::sin(turn)});
        }
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t k = (i + 1) % sides;
        triangles.push_back({2 * i, 2 * k + 1, 2 * i + 1});
        triangles.push_back({2 * i, 2 * k, 2 * k + 1});
        if (i != 0 && k != 0) {
            triangles.push_back({0, 2 * k, 2 * i});
            triangles.push_back({1, 2 * i + 1, 2 * k + 1});
        }
    }
    const Solid rod = make_solid("rod", vertices, triangles);
    ASSERT_TRUE(rod.closed && volume(rod) > 0);
    Pose across = at(0.01, 0.02, 1.7);
    across.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    const auto contacts = find_edges(rod, {}, rod, across);
    double deepest = 0;
    for (const auto& c : contacts) deepest = std::max(deepest, c.depth);
    EXPECT_NEAR(deepest, 0.3, 0.02);
}

TEST(reference_edges, of_a_box_in_a_box) {
    // Nothing crosses: the deepest vertex of the small box is the contact, towards the nearest wall, x = 1.
    const auto contacts =
        find_edges(solid(box_mesh({1, 1, 1})), {}, solid(box_mesh({0.25, 0.25, 0.25})), at(0.5, 0, 0.125));
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_EQ(contacts[0].kind, FeatureKind::inside);
    EXPECT_EQ(contacts[0].vertex_body, Side::b);
    EXPECT_NEAR(contacts[0].depth, 0.75, 1e-6);
    EXPECT_NEAR(std::fabs(contacts[0].normal.x) + std::fabs(contacts[0].normal.y) + std::fabs(contacts[0].normal.z), 1,
                1e-6);
}

TEST(reference_edges, of_a_cone_through_a_plate) {
    const Solid plate = solid(box_mesh({2, 2, 0.0625}));
    const auto contacts = find_edges(plate, {}, solid(cone_mesh()), at(0.1, 0.2, -0.5));
    EXPECT_GE(contacts.size(), 4u);
    for (const auto& c : contacts) EXPECT_LE(c.depth, 0.125 + 1e-6);
    // An open plate has no inside, so nothing is pierced.
    Mesh flat = sheet_mesh(1);
    for (Vec3& v : flat.vertices) v.z = 0;
    EXPECT_TRUE(find_edges(solid(flat), {}, solid(flat), at(0.1, 0.2, 0)).empty());
}

void set_source(Contact& c, Side source, std::uint32_t vertex, std::uint32_t triangle, const Vec3& point) {
    const Vec3 own = point;
    const bool from_a = source == Side::a;
    c.feature = {FeatureKind::vertex, source, from_a ? vertex : triangle, from_a ? triangle : vertex};
    (from_a ? c.point_a : c.point_b) = own;
}

// What the library would have to say to agree with the reference.
std::vector<Contact> as_library(const std::vector<ReferenceContact>& contacts) {
    std::vector<Contact> list;
    for (const ReferenceContact& r : contacts) {
        Contact c;
        c.body_a = {0};
        c.body_b = {1};
        set_source(c, r.vertex_body, r.vertex, r.triangle, r.point);
        c.normal = {static_cast<float>(r.normal.x), static_cast<float>(r.normal.y), static_cast<float>(r.normal.z)};
        c.depth = static_cast<float>(r.depth);
        c.ray_length = static_cast<float>(r.ray_length);
        c.weight = static_cast<float>(r.weight);
        list.push_back(c);
    }
    return list;
}

TEST(reference_compare, notices_every_kind_of_error) {
    const Solid a = solid(bumpy_octahedron_mesh(6));
    const Solid b = solid(l_prism_mesh());
    Random random(5);
    Pose pose_a = random.rotation();
    pose_a.translation = {0.25, 0.5, -0.125};
    const Pose pose_b = random.rotation();
    const std::vector<Contact> right = as_library(find_contacts(a, pose_a, b, pose_b));
    ASSERT_GE(right.size(), 10u);
    const auto verdict = [&](const std::vector<Contact>& contacts) {
        Comparison sum;
        compare(a, pose_a, b, pose_b, contacts, sum);
        EXPECT_EQ(sum.contacts, right.size());
        EXPECT_EQ(sum.excused, 0u);
        EXPECT_EQ(sum.complaints.size(), std::min<std::size_t>(sum.wrong, 5));
        return sum;
    };
    EXPECT_EQ(verdict(right).agreed, right.size());
    EXPECT_EQ(verdict(right).wrong, 0u);
    EXPECT_EQ(verdict({}).wrong, right.size()); // all missed
    const auto wrong_after = [&](auto change) {
        std::vector<Contact> list = right;
        change(list[right.size() / 2]);
        return verdict(list).wrong;
    };
    EXPECT_EQ(wrong_after([](Contact& c) {
                  set_source(c, c.feature.source, c.feature.source_index(), c.feature.other_index() ? 0 : 1, c.point());
              }),
              1u);
    EXPECT_EQ(wrong_after([](Contact& c) { c.depth += 1e-4f; }), 1u);
    EXPECT_EQ(wrong_after([](Contact& c) { c.ray_length += 1e-4f; }), 1u);
    EXPECT_EQ(wrong_after([](Contact& c) { c.weight *= 1.00001f; }), 1u);
    EXPECT_EQ(wrong_after([](Contact& c) { c.point_a.x += 1e-4, c.point_b.x += 1e-4; }), 1u);
    EXPECT_EQ(wrong_after([](Contact& c) { c.normal = {-c.normal.x, -c.normal.y, -c.normal.z}; }), 1u);
    EXPECT_EQ(
        wrong_after([](Contact& c) { set_source(c, c.feature.source, 4000, c.feature.other_index(), c.point()); }),
        2u); // one missed, one of no vertex
    std::vector<Contact> more = right;
    std::vector<bool> taken(a.vertices.size());
    for (const Contact& c : right)
        if (c.feature.source == Side::a) taken[c.feature.source_index()] = true;
    more.push_back(right[0]);
    const auto free = static_cast<std::uint32_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
    set_source(more.back(), Side::a, free, right[0].feature.other_index(), right[0].point());
    EXPECT_EQ(verdict(more).wrong, 1u); // invented
}

TEST(reference_rays, never_slip_through_an_edge) {
    const Solid box = solid(grid_box_mesh(8));
    RayCaster caster(box);
    Random random(11);
    int aimed = 0;
    for (int k = 0; k < 20000; ++k) { // from inside at vertices and points of edges: always a exit
        const auto& edge = box.edges[random.below(static_cast<std::uint32_t>(box.edges.size()))];
        const double s = k % 2 ? 0 : random.uniform();
        const Vec3 goal = (1 - s) * box.vertices[edge[0]] + s * box.vertices[edge[1]];
        const Vec3 origin = Vec3{0.5, 0.5, 0.5} + 0.25 * random.in_ball();
        const Hit hit = caster.closest(origin, unit(goal - origin));
        ASSERT_TRUE(hit.triangle != Hit::none && hit.from_inside);
        EXPECT_NEAR(hit.distance, length(goal - origin), 1e-12);
        ++aimed;
    }
    EXPECT_EQ(aimed, 20000);
}

TEST(reference_side, agrees_with_the_winding_number) {
    Random random(3);
    std::uint64_t inside = 0;
    for (const Mesh& mesh : {bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh()}) {
        const Solid s = solid(mesh);
        const SideIndex index(s);
        for (int k = 0; k < 2000; ++k) {
            const Vec3 size = s.box_max - s.box_min;
            const Vec3 p =
                s.box_min + Vec3{size.x * random.uniform(), size.y * random.uniform(), size.z * random.uniform()};
            const double winding = winding_number(s, p);
            ASSERT_EQ(index.side(p), winding > 0.5 ? SideIndex::Side::inside : SideIndex::Side::outside) << s.name;
            inside += winding > 0.5;
        }
    }
    EXPECT_GT(inside, 1000u);
    EXPECT_LT(inside, 7000u);
}

} // namespace
