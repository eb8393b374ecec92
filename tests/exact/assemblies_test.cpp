// SPDX-License-Identifier: Apache-2.0
// What the rule of edges promises of ordinary assemblies: parts flush with each other or laid flat, threads, walls
// pierced, plates and rods; and that pushing by the deepest contact brings bodies apart.
#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "exact/words.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "reference/vector.h"

#include "scenes/models/trigonometry.h"

#include <raycontact/collide.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

using namespace raycontact;
using namespace raycontact::exact;
using namespace raycontact::reference;

namespace {

using ShapePtr = std::shared_ptr<const Shape>;

ShapePtr made(const Mesh& mesh) {
    ShapePtr shape = Shape::make(mesh);
    const MeshReport& report = shape->report();
    EXPECT_TRUE(report.manifold && report.outward && !report.self_intersecting && report.repairs.empty())
        << to_text(report);
    return shape;
}

double size_of(const Shape& shape) {
    return length(shape.box_max() - shape.box_min());
}

Vec3 normal_of(const Contact& c) {
    return {double(c.normal.x), double(c.normal.y), double(c.normal.z)};
}

// Null where there is none.
const Contact* deepest_of(const std::vector<Contact>& contacts) {
    const Contact* deepest = nullptr;
    for (const Contact& c : contacts)
        if (!deepest || c.depth > deepest->depth) deepest = &c;
    return deepest;
}

// About z by `turn` of a turn, then about a level axis by a small angle.
Pose laid(double turn, const Vec3& axis, double tilt, const Vec3& where) {
    const auto [sine, cosine] = scenes::sine_cosine(turn);
    const Pose lean = small_rotation(axis, tilt);
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = lean.rotation[3 * i], y = lean.rotation[3 * i + 1];
        pose.rotation[3 * i] = x * cosine + y * sine;
        pose.rotation[3 * i + 1] = y * cosine - x * sine;
        pose.rotation[3 * i + 2] = lean.rotation[3 * i + 2];
    }
    pose.translation = where;
    return pose;
}

Pose moved_by(Pose pose, const Vec3& way) {
    pose.translation = pose.translation + way;
    return pose;
}

Pose times(const Pose& left, const Pose& right) {
    Pose pose;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            pose.rotation[3 * r + c] = 0;
            for (std::size_t k = 0; k < 3; ++k)
                pose.rotation[3 * r + c] += left.rotation[3 * r + k] * right.rotation[3 * k + c];
        }
    pose.translation = transform_point(left, right.translation);
    return pose;
}

// Of each pair the deepest contact, in units of what it may be at most.
struct Depths {
    std::size_t pairs = 0, without = 0, deep = 0, far = 0; ///< no contact; beyond `limit`; beyond `never`
    double limit = 1, never = 1, worst = 0;
    std::string words; ///< of the worst
    void add(const std::vector<Contact>& contacts, double unit, const std::string& what) {
        ++pairs;
        const Contact* deepest = deepest_of(contacts);
        if (!deepest) {
            ++without;
            return;
        }
        const double ratio = double(deepest->depth) / unit;
        deep += ratio > limit;
        far += ratio > never;
        if (ratio > worst) worst = ratio, words = what + ": " + words_of(*deepest);
    }
    void print(const char* what) const {
        std::printf("[ counts   ] %s: %zu pairs, %zu without a contact, %zu deeper than %g, %zu than %g, worst %.3g\n",
                    what, pairs, without, deep, limit, far, never, worst);
        std::fflush(stdout);
    }
};

// Turned freely, up to 50 m away, and rounded as files are.
Depths of_flush_pairs(FlushPair (*make)(std::uint32_t, double, Random&), std::uint32_t kinds, std::size_t cases) {
    Depths all;
    all.limit = 1.5, all.never = 3;
    std::vector<std::size_t> deep_of_kind(kinds, 0);
    for (std::size_t i = 0; i < cases; ++i) {
        Random random(1000003 + i);
        const auto kind = static_cast<std::uint32_t>(i % kinds);
        const FlushPair pair = make(kind, random.uniform(0.02, 0.2), random);
        Pose pose = random.rotation();
        constexpr double places[] = {1, 10, 50};
        pose.translation = places[i / kinds % 3] * random.in_ball();
        const bool text = i / kinds % 2 == 0;
        const auto rounded = [&](const Mesh& mesh) {
            return made(text ? with_six_digits(placed(mesh, pose)) : in_float32(placed(mesh, pose)));
        };
        const ShapePtr a = rounded(pair.a), b = rounded(pair.b);
        const std::size_t before = all.deep;
        all.add(collide(*a, {}, *b, {}), pair.overlap, "case " + std::to_string(i));
        deep_of_kind[kind] += all.deep - before;
    }
    std::printf("[ counts   ] too deep of each kind:");
    for (const std::size_t n : deep_of_kind) std::printf(" %zu", n);
    std::printf("\n");
    return all;
}

TEST(assemblies, flush_parts) {
    const Depths all = of_flush_pairs(flush_pair, flush_kinds, 2100);
    all.print("flush parts");
    EXPECT_EQ(all.without, 0u);
    EXPECT_EQ(all.deep, 0u) << all.words;
}

// Faces on faces that look the other way cross each other anywhere, as rounding has it.
TEST(assemblies, fitted_parts) {
    const Depths all = of_flush_pairs(fitted_pair, fitted_kinds, 600);
    all.print("fitted parts");
    EXPECT_EQ(all.without, 0u);
    EXPECT_EQ(all.deep, 0u) << all.words;
}

struct Plates {
    const char* name;
    Mesh below, above; ///< their bottoms at z = 0
};

std::vector<Plates> plates() {
    const auto plate = [](const char* name, const Outline& outline, double height = 0.1,
                          const std::vector<Outline>& holes = {}) { return extruded(name, outline, holes, 0, height); };
    const Mesh hexagon = plate("hexagon", regular(6, 0.5), 0.2);
    const Mesh bar = plate("bar", rectangle(-0.5, -0.04, 0.5, 0.04), 0.02);
    const Mesh gear = plate("gear", gear_outline(12, 0.5, 0.4), 0.1, {regular(8, 0.15)});
    const Mesh e = plate("E", shifted(e_outline(0.7, 1, 0.15), -0.35, -0.5));
    const Mesh l = plate("L", shifted(l_outline(0.8, 1, 0.2), -0.3, -0.4));
    const Mesh ring = plate("ring", regular(24, 0.5), 0.15, {regular(24, 0.35)});
    const Mesh star = plate("star", star_outline(7, 0.5, 0.2));
    const Mesh u = plate("U", shifted(u_outline(0.8, 0.9, 0.15), -0.4, -0.45));
    const Mesh box = plate("box", rectangle(-0.25, -0.15, 0.25, 0.15), 0.3);
    const Mesh wide = plate("plate", rectangle(-0.6, -0.4, 0.6, 0.4), 0.03);
    const Mesh t = plate("T", shifted(t_outline(0.8, 0.9, 0.15), 0, -0.45));
    const Mesh holes = plate("plate with holes", rectangle(-0.5, -0.5, 0.5, 0.5), 0.05,
                             {shifted(regular(12, 0.15), 0.2, 0.2), rectangle(-0.4, -0.4, -0.1, -0.2)});
    return {{"bar on hexagon", hexagon, bar},
            {"gear on E", e, gear},
            {"E on gear", gear, e},
            {"L on ring", ring, l},
            {"star on U", u, star},
            {"box on plate", wide, box},
            {"T on plate with holes", holes, t}};
}

TEST(assemblies, flat_on_flat) {
    for (const Plates& pair : plates()) {
        const ShapePtr below = made(pair.below), above = made(pair.above);
        const double reach = 0.5 * size_of(*above), top = below->box_max().z;
        for (const double overlap : {0.0005, 0.002, 0.01}) {
            Depths depths;
            depths.limit = depths.never = 3;
            Random random(77);
            for (std::size_t i = 0; i < 2000; ++i) {
                const double turn = random.uniform(), tilt = i % 2 == 0 ? 0 : 1e-3;
                const auto [sine, cosine] = scenes::sine_cosine(random.uniform());
                const Vec3 shift = 0.6 * random.in_ball();
                // A quarter as they lie, the others turned freely and moved together.
                Pose pose_a = i / 2 % 4 == 0 ? Pose{} : random.rotation();
                if (i / 2 % 4 != 0) pose_a.translation = 3 * random.in_ball();
                const Pose pose_b =
                    times(pose_a, laid(turn, {cosine, sine, 0}, tilt, {shift.x, shift.y, top - overlap}));
                const auto contacts = collide(*below, pose_a, *above, pose_b);
                if (contacts.empty() && !intersects(*below, pose_a, *above, pose_b)) continue; // beside, or over a hole
                // A corner lies at most that much lower than the middle.
                depths.add(contacts, overlap + tilt * reach, std::string(pair.name) + " " + std::to_string(i));
            }
            char what[80];
            std::snprintf(what, sizeof what, "%s, %g mm", pair.name, 1000 * overlap);
            depths.print(what);
            EXPECT_EQ(depths.without, 0u);
            EXPECT_EQ(depths.deep, 0u) << depths.words;
            EXPECT_GE(depths.pairs, 1000u);
        }
    }
}

// A cube as it should not be: the open one, one that lacks a triangle, two in one mesh that share an edge or a corner,
// or cross each other. Its bottom is at z = 0.
std::vector<Mesh> faulty_cubes() {
    const Mesh cube = moved(box_mesh({0.2, 0.2, 0.2}), {0, 0, 0.2});
    const auto with = [&](const char* name, const Vec3& where) {
        Mesh both = cube;
        both.name = name;
        const auto first = static_cast<std::uint32_t>(both.vertices.size());
        for (const Vec3& v : cube.vertices) both.vertices.push_back(v + where);
        for (const auto& t : cube.triangles) both.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        return both;
    };
    Mesh lacking = cube;
    lacking.name = "lacks a triangle";
    lacking.triangles.pop_back();
    Mesh open = open_box_mesh(4);
    open.name = "open";
    for (Vec3& v : open.vertices) v = {0.4 * v.x - 0.2, 0.4 * v.y - 0.2, 0.4 * v.z};
    return {open,
            lacking,
            with("share an edge", {0.4, 0.4, 0}),
            with("share a corner", {0.4, 0.4, 0.4}),
            with("cross each other", {0.1, 0.15, 0.05}),
            with("share a face", {0.4, 0.1, 0})};
}

// Loops that do not close give what the sum still tells, or nothing; never the depth of a body.
TEST(assemblies, faulty_meshes_laid_flat) {
    const ShapePtr hexagon = made(extruded("hexagon", regular(6, 0.5), {}, -0.2, 0));
    for (const Mesh& mesh : faulty_cubes()) {
        const ShapePtr cube = Shape::make(mesh);
        Depths depths;
        depths.limit = depths.never = 3;
        for (const double overlap : {0.002, 0.01})
            for (std::size_t i = 0; i < 250; ++i) {
                Random random(500 + i);
                const Vec3 shift = 0.6 * random.in_ball();
                const Pose pose = laid(random.uniform(), {1, 0, 0}, 0, {shift.x, shift.y, -overlap});
                if (!intersects(*hexagon, {}, *cube, pose)) continue;
                const std::string what = mesh.name + " " + std::to_string(i);
                depths.add(collide(*hexagon, {}, *cube, pose), overlap, what);
                depths.add(collide(*cube, pose, *hexagon, {}), overlap, what + " swapped");
            }
        depths.print(("cubes that " + mesh.name).c_str());
        EXPECT_EQ(depths.deep, 0u) << depths.words;
    }
}

// How far the corners of one thread's polygon stand out over the sides of the other's: all that a nut in its place
// overlaps its bolt.
double stands_out() {
    return thread_radius * (1 - scenes::sine_cosine(0.5 / thread_sides).cosine);
}

// The deepest contacts, in units of the overlap, while the nut turns from above the bolt to below it, by up to `off`
// beside its place.
Depths of_turning_nut(double clearance, double off, int poses) {
    const ShapePtr bolt = made(bolt_mesh(10)), nut = made(nut_mesh(4, clearance));
    Depths depths;
    depths.limit = 3, depths.never = 10;
    Random random(20);
    for (int i = 0; i < poses; ++i) {
        const double turns = 10.5 - (16.0 * i + random.uniform()) / poses;
        const Vec3 beside = off * random.in_ball();
        const Pose pose = laid(turns, {1, 0, 0}, 0, Vec3{0, 0, turns * thread_pitch} + beside);
        const auto contacts = collide(*bolt, {}, *nut, pose);
        if (contacts.empty() && !intersects(*bolt, {}, *nut, pose)) continue;
        depths.add(contacts, length(beside) + stands_out(), "pose " + std::to_string(i));
    }
    return depths;
}

TEST(assemblies, nut_on_bolt) {
    for (const double clearance : {0.0, 0.001, 0.002, 0.003}) {
        const Depths depths = of_turning_nut(clearance, 0, 240);
        char what[80];
        std::snprintf(what, sizeof what, "nut on bolt, %g mm wider, unit %.4g m", 1000 * clearance, stands_out());
        depths.print(what);
        EXPECT_EQ(depths.without, 0u);
        EXPECT_LE(depths.deep, 1u) << depths.words;
        EXPECT_GE(depths.pairs, 60u);
    }
}

// It has come free if it moves back to its place.
TEST(assemblies, nut_beside_its_place) {
    for (const double off : {0.003, 0.01, 0.03}) {
        const Depths depths = of_turning_nut(0.002, off, 160);
        char what[80];
        std::snprintf(what, sizeof what, "nut up to %g mm beside its place", 1000 * off);
        depths.print(what);
        EXPECT_EQ(depths.without, 0u);
        EXPECT_LE(depths.deep, 8u) << depths.words;
        EXPECT_LE(depths.far, 3u) << depths.words;
        EXPECT_GE(depths.pairs, 80u);
    }
}

TEST(assemblies, wall_pierced) {
    Random random(4);
    double least = 1, most = 0;
    std::size_t cases = 0, without = 0;
    const ShapePtr wall = made(box_mesh({4, 3, 0.1}));
    for (const double long_by : {2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0})
        for (const double radius : {0.05, 0.15, 0.4})
            for (const int form : {0, 1, 2}) {
                const ShapePtr pipe = made(form == 0   ? prism_solid(24, radius, long_by / 2)
                                           : form == 1 ? pipe_mesh(24, radius, 0.8 * radius, long_by)
                                                       : box_mesh({radius, 0.7 * radius, long_by / 2}));
                for (int i = 0; i < 8; ++i) {
                    const Pose pose_a = random.rotation();
                    const double far = random.uniform(-0.45, 0.45) * (long_by - 1);
                    const Vec3 where{random.uniform(-2, 2), random.uniform(-2, 2), far};
                    const Pose in_a = laid(random.uniform(), {1, 0, 0}, 0, where);
                    const auto contacts = collide(*wall, pose_a, *pipe, times(pose_a, in_a));
                    ++cases;
                    const Contact* deepest = deepest_of(contacts);
                    if (!deepest) {
                        ++without;
                        continue;
                    }
                    least = std::min(least, double(deepest->depth));
                    most = std::max(most, double(deepest->depth));
                }
            }
    std::printf("[ counts   ] walls pierced: %zu cases, %zu without a contact, deepest from %.4g to %.4g m\n", cases,
                without, least, most);
    EXPECT_EQ(without, 0u);
    EXPECT_NEAR(least, 0.2, 0.002);
    EXPECT_NEAR(most, 0.2, 0.002);
}

// Just below the surface, both ends overhanging: the loops around them cancel.
TEST(assemblies, sunk_bar) {
    const ShapePtr hexagon = made(extruded("hexagon", regular(6, 0.5), {}, 0, 0.2));
    const ShapePtr bar = made(extruded("bar", rectangle(-0.5, -0.04, 0.5, 0.04), {}, 0, 0.02));
    std::size_t cases = 0, without = 0, upwards = 0, deep = 0;
    std::string words;
    for (const double z : {0.17, 0.175, 0.165, 0.16})
        for (const double turn : {0.0, 1.0 / 72, 1.0 / 24, 1.0 / 12, 0.1, 0.21})
            for (const Vec3& shift : {Vec3{}, Vec3{0.004, 0.01, 0}, Vec3{-0.003, 0.006, 0}})
                for (const bool swapped : {false, true}) {
                    const Pose pose = laid(turn, {1, 0, 0}, 0, shift + Vec3{0, 0, z});
                    auto contacts = swapped ? collide(*bar, pose, *hexagon, {}) : collide(*hexagon, {}, *bar, pose);
                    ++cases;
                    const Contact* deepest = deepest_of(contacts);
                    if (!deepest) {
                        ++without;
                        continue;
                    }
                    const bool up = (swapped ? -1 : 1) * double(deepest->normal.z) > 0.9;
                    const bool right = std::fabs(double(deepest->depth) - (0.2 - z)) < 0.1 * (0.2 - z);
                    upwards += up;
                    deep += right;
                    if (!(up && right) && words.empty()) words = words_of(*deepest);
                }
    std::printf("[ counts   ] sunk bar: %zu cases, %zu without a contact, %zu upwards, %zu as deep as it is sunk\n",
                cases, without, upwards, deep);
    EXPECT_EQ(without, 0u);
    EXPECT_EQ(upwards, cases) << words;
    EXPECT_EQ(deep, cases) << words;
}

TEST(assemblies, thin_plate) {
    const ShapePtr thin = made(box_mesh({1, 1, 0.005})), thick = made(box_mesh({1, 1, 0.02}));
    const ShapePtr cube = made(box_mesh({0.1, 0.1, 0.1}));
    Random random(6);
    std::size_t both = 0, without = 0;
    std::string words;
    for (int i = 0; i < 200; ++i) {
        const auto [sine, cosine] = scenes::sine_cosine(random.uniform());
        const Vec3 where{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.06, 0.06)};
        const double tilt = random.uniform(0.001, 0.8);
        const Shape& plate = i % 2 == 0 ? *thin : *thick;
        const auto contacts = collide(plate, {}, *cube, laid(random.uniform(), {cosine, sine, 0}, tilt, where));
        const Contact* deepest = deepest_of(contacts);
        if (!deepest) {
            ++without;
            continue;
        }
        bool opposed = false;
        for (const Contact& c : contacts)
            for (const Contact& d : contacts)
                opposed |=
                    std::min(c.depth, d.depth) >= 0.1f * deepest->depth && dot(normal_of(c), normal_of(d)) < -0.5;
        both += opposed;
        if (opposed && words.empty()) {
            words = "pose " + std::to_string(i);
            for (const Contact& c : contacts) words += '\n' + words_of(c);
        }
    }
    std::printf("[ counts   ] thin plate: 200 poses, %zu without a contact, %zu pushed both ways\n", without, both);
    EXPECT_EQ(without, 0u);
    EXPECT_EQ(both, 0u) << words;
}

TEST(assemblies, tray_corner) {
    const ShapePtr tray = made(tray_mesh()), cube = made(box_mesh({0.3, 0.3, 0.3}));
    Random random(9);
    Depths depths;
    depths.limit = depths.never = 3;
    for (int i = 0; i < 1000; ++i) {
        const double e = 1e-4 * std::pow(100, random.uniform());
        const auto in = [&] { return random.uniform(0.1 * e, e); };
        const Vec3 turn = e * random.direction();
        Pose pose = pose_from_quaternion({}, 1, turn.x / 2, turn.y / 2, turn.z / 2);
        pose.translation = {-0.5 - in(), -0.5 - in(), 0.5 - in()};
        depths.add(collide(*tray, {}, *cube, pose), e, "pose " + std::to_string(i));
    }
    depths.print("cube in the corner of a tray");
    EXPECT_EQ(depths.without, 0u);
    EXPECT_EQ(depths.deep, 0u) << depths.words;
}

TEST(assemblies, crossed_rods) {
    const double radius = 0.4, stands_out = radius * (1 - scenes::sine_cosine(0.5 / 32).cosine);
    const ShapePtr rod = made(prism_solid(32, radius, 2));
    Random random(8);
    double least = 10, most = 0;
    std::size_t cases = 0, without = 0;
    std::string words;
    for (const double angle : {0.05, 0.1, 0.15, 0.2, 0.25}) // of a turn
        for (const double overlap : {0.05, 0.1, 0.175, 0.3, 0.4})
            for (int i = 0; i < 10; ++i) {
                // One along z; the other in the plane of y and z, aside along x. Both turned about their axes.
                const auto [sine, cosine] = scenes::sine_cosine(angle);
                Pose lying;
                lying.rotation = {1, 0, 0, 0, cosine, -sine, 0, sine, cosine};
                const Pose spin = laid(random.uniform(), {1, 0, 0}, 0, {});
                Pose pose_b = times(lying, spin);
                pose_b.translation = {2 * radius - overlap, random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
                const auto contacts = collide(*rod, laid(random.uniform(), {1, 0, 0}, 0, {}), *rod, pose_b);
                ++cases;
                const Contact* deepest = deepest_of(contacts);
                if (!deepest) {
                    ++without;
                    continue;
                }
                const double depth = double(deepest->depth);
                if (depth / (overlap - stands_out) < least)
                    least = depth / (overlap - stands_out), words = words_of(*deepest);
                most = std::max(most, depth / overlap);
            }
    std::printf(
        "[ counts   ] crossed rods: %zu cases, %zu without a contact, deepest from %.3g to %.3g of the overlap\n",
        cases, without, least, most);
    EXPECT_EQ(without, 0u);
    EXPECT_GE(least, 0.76) << words;
    EXPECT_LE(most, 1.1);
}

struct Posed {
    ShapePtr a, b;
    Pose pose_a, pose_b;
    double larger() const { return std::max(size_of(*a), size_of(*b)); }
    double smaller() const { return std::min(size_of(*a), size_of(*b)); }
    bool intersect() const { return intersects(*a, pose_a, *b, pose_b); }
    std::vector<Contact> contacts() const { return collide(*a, pose_a, *b, pose_b); }
};

// Turned freely, the middles of their boxes up to `apart` of both sizes from each other.
Posed random_pair(const std::vector<ShapePtr>& bodies, double apart, Random& random) {
    const auto any = [&] { return bodies[random.below(static_cast<std::uint32_t>(bodies.size()))]; };
    Posed pair{any(), any(), random.rotation(), random.rotation()};
    const Vec3 middle = 5 * random.in_ball();
    const Vec3 offset = (apart * (pair.larger() + pair.smaller())) * random.in_ball();
    pair.pose_a.translation = middle - rotate(pair.pose_a, pair.a->centre());
    pair.pose_b.translation = middle + offset - rotate(pair.pose_b, pair.b->centre());
    return pair;
}

std::vector<ShapePtr> coarse_bodies(bool thin_too) {
    Random random(14);
    std::vector<ShapePtr> bodies;
    while (bodies.size() < 400) {
        const Mesh mesh = coarse_solid(random);
        if (thin_too || (mesh.name != "sheet" && mesh.name != "needle")) bodies.push_back(made(mesh));
    }
    return bodies;
}

// Whether the answer changes when b moves by that much in one of some directions.
bool touches(const Posed& pair, bool truth, double metres) {
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const Vec3 way = metres * unit(Vec3{double(x), double(y), double(z)});
                if (intersects(*pair.a, pair.pose_a, *pair.b, moved_by(pair.pose_b, way)) != truth) return true;
            }
    return false;
}

TEST(assemblies, none_missed_none_invented) {
    const auto bodies = coarse_bodies(true);
    std::size_t intersect = 0, apart = 0, missed = 0, invented = 0, excused = 0, contacts = 0, deep = 0, too_deep = 0;
    for (std::size_t i = 0; i < 4000; ++i) {
        Random random(2000003 + i);
        const Posed pair = random_pair(bodies, 0.3, random);
        const bool truth = pair.intersect();
        ++(truth ? intersect : apart);
        const auto found = pair.contacts();
        contacts += found.size();
        if (truth == found.empty())
            ++(touches(pair, truth, 1e-6 * pair.larger()) ? excused : truth ? missed : invented);
        for (const Contact& c : found) {
            EXPECT_TRUE(std::isfinite(c.depth) && c.depth > 0) << words_of(c);
            EXPECT_NEAR(length(normal_of(c)), 1, 1e-5) << words_of(c);
            deep += double(c.depth) > pair.smaller();
            too_deep += double(c.depth) > pair.larger();
        }
    }
    std::printf(
        "[ counts   ] coarse pairs: %zu intersect, %zu apart; %zu missed, %zu invented, %zu excused; %.3g contacts "
        "a pair that intersects, %zu deeper than the smaller body, %zu than the larger\n",
        intersect, apart, missed, invented, excused, double(contacts) / double(intersect), deep, too_deep);
    EXPECT_EQ(missed, 0u);
    EXPECT_EQ(invented, 0u);
    EXPECT_LE(excused, 20u);
    EXPECT_EQ(too_deep, 0u);
}

// How often b has to be pushed out by its deepest contact until it is apart. Sheets and needles, a thousandth thick,
// stay out: pierced in the middle, they would have to be pushed a thousand times.
TEST(assemblies, pushes) {
    constexpr std::size_t wanted = 1400;
    constexpr std::array<std::size_t, 5> pushes{1, 2, 3, 5, 12};
    const auto bodies = coarse_bodies(false);
    std::size_t pairs = 0, contacts_first = 0, stopped = 0;
    std::array<std::size_t, 5> free{};
    double way = 0;
    for (std::size_t i = 0; pairs < wanted; ++i) {
        Random random(3000003 + i);
        Posed pair = random_pair(bodies, 0.25, random);
        if (pair.larger() > 3 * pair.smaller() || !pair.intersect()) continue;
        ++pairs;
        double gone = 0;
        for (std::size_t done = 1; done <= pushes.back(); ++done) {
            const auto contacts = pair.contacts();
            if (done == 1) contacts_first += contacts.size();
            const Contact* deepest = deepest_of(contacts);
            if (!deepest) {
                ++stopped;
                break;
            }
            const double by = double(deepest->depth) + 1e-6 * pair.smaller();
            pair.pose_b = moved_by(pair.pose_b, by * normal_of(*deepest));
            gone += by;
            if (pair.intersect()) continue;
            for (std::size_t k = 0; k < pushes.size(); ++k) free[k] += done <= pushes[k];
            break;
        }
        way += gone / pair.smaller();
    }
    way /= double(wanted);
    std::printf(
        "[ counts   ] pushes: of %zu pairs apart after 1, 2, 3, 5, 12: %zu %zu %zu %zu %zu; mean way %.3g of the "
        "smaller; %zu without a contact on the way; %.3g contacts a pair at first\n",
        pairs, free[0], free[1], free[2], free[3], free[4], way, stopped, double(contacts_first) / wanted);
    // 1 % below what the rule reached at first: 530, 1030, 1206, 1308 and 1357.
    constexpr std::array<std::size_t, 5> least{525, 1020, 1194, 1295, 1343};
    for (std::size_t k = 0; k < pushes.size(); ++k) EXPECT_GE(free[k], least[k]) << pushes[k] << " pushes";
    EXPECT_LE(way, 0.27);
    EXPECT_LE(stopped, 3u); // some perturbations deep
}

} // namespace
