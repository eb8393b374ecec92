// SPDX-License-Identifier: Apache-2.0
// Pairs by hand, with edges: each with both casters, both orders of the bodies, at the origin and 10 km away, asked
// once and as the last of 20 steps of a scene that moves there, by `standard` and `certified`.
#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "exact/words.h"
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "reference/vector.h"

#include "scenes/models/procedural.h"

#include <raycontact/collide.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

using namespace raycontact;
using namespace raycontact::exact;
using namespace raycontact::reference;

namespace {

enum class Answer { no, yes, either };

struct Case {
    std::string name;
    std::shared_ptr<const Shape> a, b;
    Pose pose_b; ///< in the frame of a
    Answer answer;
    double deepest; ///< metres that no contact may exceed
};

using ShapePtr = std::shared_ptr<const Shape>;

Pose at(double x, double y, double z) {
    Pose pose;
    pose.translation = {x, y, z};
    return pose;
}

// About z, by an angle with this tangent.
Pose about_z(double tangent, const Vec3& where) {
    const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
    Pose pose;
    pose.rotation = {cosine, -sine, 0, sine, cosine, 0, 0, 0, 1};
    pose.translation = where;
    return pose;
}

double perturbation(const Case& c) {
    const auto size = [](const Shape& s) { return length(s.box_max() - s.box_min()); };
    return 1e-7 * std::min(size(*c.a), size(*c.b));
}

// The first contact that two lists do not share.
std::string difference(const std::vector<Contact>& p, const std::vector<Contact>& q) {
    std::size_t i = 0;
    while (i < p.size() && i < q.size() && same_bits({&p[i], 1}, {&q[i], 1})) ++i;
    std::string text = ", " + std::to_string(p.size()) + " and " + std::to_string(q.size());
    for (const auto* list : {&p, &q}) {
        if (i >= list->size()) continue;
        text += "; " + words_of((*list)[i]);
    }
    return text;
}

class Trial {
public:
    // Of every way to ask; the first few failures are told.
    void ask(const Case& c) {
        for (const bool swapped : {false, true})
            for (const bool far : {false, true}) {
                std::vector<Contact> reference;
                bool first = true;
                for (const Caster caster : {Caster::bvh, Caster::basic})
                    for (const Method method : {Method::standard, Method::certified})
                        for (const bool moving : {false, true}) {
                            const auto contacts = contacts_of(c, swapped, far, caster, method, moving);
                            std::string way = c.name + (swapped ? ", swapped" : "") + (far ? ", at 10 km" : "")
                                              + (moving ? ", moved there" : "") + ", " + std::string(to_string(caster))
                                              + ", " + std::string(to_string(method));
                            check(c, contacts, way);
                            if (first) reference = contacts;
                            first = false;
                            expect(same_bits(reference, contacts),
                                   way + ": other contacts than asked once" + difference(reference, contacts));
                        }
            }
        ++cases_;
    }
    ~Trial() { std::printf("[ counts   ] %zu cases, %zu ways of asking, %zu failed\n", cases_, asked_, failed_); }

private:
    static std::vector<Contact> contacts_of(const Case& c, bool swapped, bool far, Caster caster, Method method,
                                            bool moving) {
        Settings settings;
        settings.features = Features::edges;
        settings.paper.caster = caster;
        settings.method = method;
        settings.execution.threads = 1;
        Scene scene(settings);
        Pose pose_a, pose_b = c.pose_b;
        if (far) pose_a.translation = {8000, 0, 6000}, pose_b.translation = pose_b.translation + pose_a.translation;
        const BodyId first = swapped ? scene.add(c.b, pose_b) : scene.add(c.a, pose_a);
        const BodyId second = swapped ? scene.add(c.a, pose_a) : scene.add(c.b, pose_b);
        const std::vector<Pair> pairs{{first, second}};
        const BodyId mover = swapped ? first : second;
        for (int step = moving ? 19 : 0; step >= 0; --step) {
            Pose pose = pose_b;
            pose.translation = pose.translation + (0.002 * step) * Vec3{0.5, 0.7, 1};
            scene.set_pose(mover, pose);
            scene.find_contacts(pairs);
        }
        return {scene.contacts().begin(), scene.contacts().end()};
    }

    void check(const Case& c, const std::vector<Contact>& contacts, const std::string& way) {
        ++asked_;
        if (c.answer == Answer::yes) expect(!contacts.empty(), way + ": missed");
        for (const Contact& contact : contacts) {
            const auto& n = contact.normal;
            const double size = std::sqrt(double(n.x) * n.x + double(n.y) * n.y + double(n.z) * n.z);
            expect(std::fabs(size - 1) < 1e-5, way + ": a normal that is not unit");
            expect(contact.depth > 0, way + ": a depth that is not above 0");
            expect(double(contact.depth) <= c.deepest, way + ": depth " + std::to_string(contact.depth) + " above "
                                                           + std::to_string(c.deepest) + " of feature "
                                                           + std::to_string(int(contact.feature.kind)));
        }
        if (c.answer == Answer::no) expect(contacts.empty(), way + ": invented");
    }

    void expect(bool good, const std::string& what) {
        if (good) return;
        if (++failed_ <= 20) ADD_FAILURE() << what;
        if (failed_ == 21) ADD_FAILURE() << "...";
    }

    std::size_t cases_ = 0, asked_ = 0, failed_ = 0;
};

ShapePtr box(double x, double y, double z) {
    static std::map<std::array<double, 3>, ShapePtr> made;
    ShapePtr& shape = made[{x, y, z}];
    if (!shape) shape = Shape::make(box_mesh({x, y, z}));
    return shape;
}

std::string text(double x) {
    char out[40];
    std::snprintf(out, sizeof out, "%g", x);
    return out;
}

// Between touching and this, in perturbations, any answer will do; depths of what touches must not exceed it either.
constexpr double touching = 4;

Answer answer_for(const Case& c, double overlap) {
    return overlap > touching * perturbation(c)    ? Answer::yes
           : overlap < -touching * perturbation(c) ? Answer::no
                                                   : Answer::either;
}

std::vector<Mesh> solids() {
    Random random(5);
    std::vector<Mesh> list{tetrahedron_mesh(),
                           box_mesh({0.5, 0.5, 0.5}),
                           box_mesh({1, 0.1, 0.1}),
                           box_mesh({1, 1, 0.02}),
                           prism_solid(6, 0.5, 0.5),
                           cone_solid(8, 0.5, 1),
                           frame_mesh(),
                           l_prism_mesh(),
                           bumpy_octahedron_mesh(2),
                           scenes::gear(48),
                           scenes::knot(60),
                           scenes::bumpy_torus(192)};
    while (list.size() < 16) {
        Mesh mesh = coarse_solid(random);
        if (mesh.triangles.size() <= 60) list.push_back(std::move(mesh));
    }
    return list;
}

TEST(exact_cases, identical_copies) {
    Trial trial;
    Random random(6);
    for (const Mesh& mesh : solids()) {
        const auto shape = Shape::make(mesh);
        const double size = length(shape->box_max() - shape->box_min());
        trial.ask({"copies of " + shape->name(), shape, shape, {}, Answer::yes, size});
        const Vec3 extent = shape->box_max() - shape->box_min();
        const double thinnest = std::min({extent.x, extent.y, extent.z});
        const bool large = mesh.triangles.size() > 50; // slow, so only some shifts
        for (const double shift : {1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3}) {
            if ((large && shift != 1e-7 && shift != 1e-3) || shift > thinnest / 4) continue;
            Case c{"copies of " + shape->name() + " shifted by " + text(shift), shape, shape, {}, Answer::yes, size};
            c.pose_b.translation = shift * random.direction();
            trial.ask(c);
        }
    }
}

TEST(exact_cases, one_inside_the_other) {
    Trial trial;
    const auto sphere = Shape::make(scenes::round_sphere(600)), torus = Shape::make(scenes::bumpy_torus(504));
    const std::vector<std::pair<const char*, ShapePtr>> small{
        {"box", box(0.05, 0.05, 0.05)}, {"bar", box(0.15, 0.01, 0.01)}, {"grain", box(1e-4, 1e-4, 1e-4)}};
    for (const auto& [name, inner] : small) {
        const double half = inner->box_max().x;
        for (const double deep : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.2, 0.3, 0.34}) {
            const double x = 0.5 - half - deep;
            trial.ask({std::string(name) + " in a cube by " + text(deep), box(0.5, 0.5, 0.5), inner, at(x, 0.01, 0),
                       Answer::yes, 0.51});
            trial.ask({std::string(name) + " turned in a cube by " + text(deep), box(0.5, 0.5, 0.5), inner,
                       about_z(0.3, {x - 0.2 * half, 0.01, 0.02}), Answer::yes, 0.51});
        }
        for (const double x : {0.0, 0.1, 0.2, 0.3, 0.34})
            trial.ask({std::string(name) + " in a sphere, out by " + text(x), sphere, inner, about_z(0.3, {x, 0, 0}),
                       Answer::yes, 0.51});
    }
    for (const double part : {0.999999, 0.9999, 0.99, 0.5}) {
        const auto inner = box(0.5 * part, 0.5 * part, 0.5 * part);
        trial.ask({"cube in a cube, " + text(part) + " as large", box(0.5, 0.5, 0.5), inner, {}, Answer::yes, 0.51});
    }
    // In the tube of a torus, and in the hole of a frame.
    Case grain{"grain in a tube", torus, box(1e-4, 1e-4, 1e-4), {}, Answer::yes, 0.3};
    grain.pose_b.translation = torus->vertices()[0] - 0.03 * torus->vertex_normals()[0];
    trial.ask(grain);
    trial.ask(
        {"box in the hole of a frame", Shape::make(frame_mesh()), box(0.2, 0.2, 0.05), at(0, 0, 0.125), Answer::no, 0});
    trial.ask({"box that fills the hole of a frame", Shape::make(frame_mesh()), box(0.37, 0.37, 0.2), at(0, 0, 0.125),
               Answer::no, 0});
    // A hollow cube: what floats in the hollow is outside.
    Mesh hollow = box_mesh({0.5, 0.5, 0.5});
    for (const Vec3& v : box_mesh({0.4, 0.4, 0.4}).vertices) hollow.vertices.push_back(v);
    for (const auto& t : box_mesh({0.4, 0.4, 0.4}).triangles)
        hollow.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    const auto shell = Shape::make(hollow);
    ASSERT_TRUE(shell->report().outward);
    trial.ask({"cube in a hollow", shell, box(0.1, 0.1, 0.1), about_z(0.2, {0.1, 0, 0}), Answer::no, 0});
    trial.ask({"grain in the wall of a hollow cube", shell, box(0.01, 0.01, 0.01), about_z(0.2, {0.45, 0, 0}),
               Answer::yes, 0.11});
    trial.ask({"hollow cube around a larger one's hollow", shell, box(0.45, 0.45, 0.45), {}, Answer::yes, 1});
}

TEST(exact_cases, crossed_bars) {
    Trial trial;
    const auto bar = box(1, 0.1, 0.1);
    for (const double tangent : {1e-3, 0.1, 1.0, 30.0, 1e12})
        for (const double overlap : {-1e-3, -1e-5, -1e-8, 0.0, 1e-8, 1e-5, 1e-3, 0.05, 0.1, 0.2}) {
            Case c{"bars crossed by tangent " + text(tangent) + ", overlap " + text(overlap),
                   bar,
                   bar,
                   about_z(tangent, {0.01, 0.02, 0.2 - overlap}),
                   Answer::either,
                   0};
            c.answer = answer_for(c, overlap);
            c.deepest = std::max(1.001 * overlap, touching * perturbation(c));
            trial.ask(c);
        }
}

// Round bodies: both ends of each edge's piece lie on the other's surface, and the edge is deep between them.
TEST(exact_cases, crossed_rods_are_as_deep_as_they_overlap) {
    Pose lying; // its axis along y
    lying.rotation = {1, 0, 0, 0, 0, -1, 0, 1, 0};
    for (const std::uint32_t corners : {12u, 32u, 64u})
        for (const double half : {0.5, 3.0}) {
            const auto rod = Shape::make(prism_solid(corners, 0.4, half));
            const double edge = 0.4 * (1 - std::cos(M_PI / corners)); // between corner and side
            for (const double overlap : {0.05, 0.1, 0.175, 0.3, 0.4}) {
                lying.translation = {0.8 - overlap, 0.011, 0.037};
                double deepest = 0;
                for (const Contact& c : collide(*rod, {}, *rod, lying)) deepest = std::max(deepest, double(c.depth));
                EXPECT_NEAR(deepest, overlap, 0.1 * overlap + 2 * edge) << corners << " corners, half " << half;
            }
        }
}

// A roof along x, its ridge at z = 0, cut finely across; beside it a pillar that ends at this height.
Mesh roof_and_pillar(double segment, double pillar) {
    const auto sections = 2 * static_cast<std::uint32_t>(0.5 / segment) + 2;
    Mesh mesh;
    mesh.name = "roof";
    for (std::uint32_t i = 0; i < sections; ++i) {
        const double x = (i - 0.5 * (sections - 1)) * segment;
        mesh.vertices.insert(mesh.vertices.end(), {{x, -0.2, -0.2}, {x, 0.2, -0.2}, {x, 0, 0}});
        for (std::uint32_t k = 0; k < 3 && i + 1 < sections; ++k) {
            const std::uint32_t p = 3 * i + k, q = 3 * i + (k + 1) % 3;
            mesh.triangles.insert(mesh.triangles.end(), {{p, q, q + 3}, {p, q + 3, p + 3}});
        }
    }
    const std::uint32_t last = 3 * (sections - 1);
    mesh.triangles.insert(mesh.triangles.end(), {{0, 2, 1}, {last, last + 1, last + 2}});
    const Mesh box = box_mesh({0.03, 0.03, 0.1});
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : box.vertices) mesh.vertices.push_back(v + Vec3{0.3, 0.32, pillar - 0.1});
    for (const auto& [p, q, r] : box.triangles) mesh.triangles.push_back({first + p, first + q, first + r});
    return mesh;
}

// Where vertices are in contact elsewhere, too: two ridges cross with no vertex of either in the other.
TEST(exact_cases, ridges_that_cross_are_told_though_a_pillar_touches) {
    Pose turned; // upside down, the ridge along y
    turned.rotation = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    for (const double pillar : {-0.1, 0.01}) {
        const auto roof = Shape::make(roof_and_pillar(0.05, pillar));
        for (const double overlap : {0.013, 0.02}) {
            turned.translation = {0, 0, -overlap};
            double ridges = 0;
            std::size_t vertices = 0;
            for (const Contact& c : collide(*roof, {}, *roof, turned)) {
                vertices += c.feature.kind == FeatureKind::vertex;
                if (c.feature.kind == FeatureKind::edges && length(c.point()) < 0.05) ridges = double(c.depth);
            }
            EXPECT_NEAR(ridges, overlap, 1e-3) << "pillar to " << pillar;
            EXPECT_EQ(vertices > 0, pillar > 0);
        }
    }
}

// Concave edges of the tray lie in the cube along its whole side: no face of the cube is a exit for all of them.
TEST(exact_cases, a_cube_in_the_corner_of_a_tray) {
    const auto tray = Shape::make(tray_mesh()), cube = box(0.3, 0.3, 0.3);
    ASSERT_TRUE(tray->report().closed && tray->report().outward);
    Random random(9);
    for (const double e : {1e-5, 1e-4, 1e-3, 1e-2})
        for (int i = 0; i < 250; ++i) {
            const auto in = [&] { return random.uniform(0.1 * e, e); };
            const Vec3 turn = e * random.direction();
            Pose pose = pose_from_quaternion({}, 1, turn.x / 2, turn.y / 2, turn.z / 2);
            pose.translation = {-0.5 - in(), -0.5 - in(), 0.5 - in()};
            const auto contacts = collide(*tray, {}, *cube, pose);
            EXPECT_FALSE(contacts.empty());
            for (const Contact& c : contacts) EXPECT_LT(double(c.depth), 3 * e) << words_of(c);
        }
}

// Both ends of a body are pressed into opposite walls: two places, each with its own exit, though one flat rim, long
// edges and the diagonals of flat faces run from one to the other.
TEST(exact_cases, a_body_pressed_between_two_walls) {
    const auto tray = Shape::make(tray_mesh());
    for (const double e : {1e-5, 1e-4, 1e-3, 1e-2})
        for (const double half_width : {0.1, 0.7})
            for (const double top : {0.8, 1.1}) {
                const auto block = box(0.8 + e, half_width, 0.2);
                const auto contacts = collide(*tray, {}, *block, at(0, 0.01, top - 0.2));
                EXPECT_GE(contacts.size(), 4u);
                for (const Contact& c : contacts) EXPECT_LT(double(c.depth), 2 * e) << words_of(c);
            }
}

TEST(exact_cases, a_plate_pierced_straight_is_left_by_one_side) {
    const auto plate = box(1, 1, 0.005), cube = box(0.1, 0.1, 0.1);
    for (const double z : {-0.05, -0.01, 0.0, 0.01, 0.05}) {
        std::size_t up = 0, down = 0;
        for (const Contact& c : collide(*plate, {}, *cube, at(0.31, 0.17, z))) {
            up += c.normal.z > 0.9f;
            down += c.normal.z < -0.9f;
        }
        EXPECT_GE(up + down, 4u);
        EXPECT_TRUE(up == 0 || down == 0) << "the middle of the cube at " << z << ": " << up << " up, " << down;
    }
}

TEST(exact_cases, cone_through_plate) {
    Trial trial;
    const auto plate = box(1, 1, 0.05);
    for (const std::uint32_t corners : {3u, 4u, 8u, 24u}) {
        const auto cone = Shape::make(cone_solid(corners, 0.4, 1));
        for (const double out : {-0.1, -1e-3, -1e-5, 0.0, 1e-5, 1e-3, 0.05, 0.1, 0.1001, 0.15, 0.5, 0.9}) {
            // Its apex points down and is `out` below the plate's upper side.
            Case c{"cone of " + text(corners) + " corners through a plate by " + text(out),
                   plate,
                   cone,
                   {},
                   Answer::either,
                   0};
            c.pose_b.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
            c.pose_b.translation = {0.013, 0.007, 0.05 - out + 1};
            c.answer = answer_for(c, out);
            c.deepest = std::max(1.001 * std::min(out, 0.1), touching * perturbation(c));
            trial.ask(c);
        }
    }
}

TEST(exact_cases, aligned_cubes) {
    Trial trial;
    const auto cube = box(0.5, 0.5, 0.5);
    for (const double overlap : {-0.01, -1e-4, -1e-5, -1e-8, 0.0, 1e-9, 1e-8, 1.8e-7, 2e-7, 3e-7, 4e-7, 1e-6, 1e-5,
                                 1e-4, 1e-3, 0.01, 0.1, 0.3, 0.5})
        for (const double shift : {0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3})
            for (const double other : {0.0, 1.0, -0.3}) {
                Case c{"cubes overlap by " + text(overlap) + ", shifted by " + text(shift) + " x (1, " + text(other)
                           + ")",
                       cube,
                       cube,
                       at(1 - overlap, shift, other * shift),
                       Answer::either,
                       0};
                c.answer = answer_for(c, overlap);
                c.deepest = std::max(1.0001 * overlap + perturbation(c), touching * perturbation(c));
                trial.ask(c);
            }
}

// The end of a bar on a plate of nearly its own width: overlaps of a few perturbations, and the exits beside are far.
TEST(exact_cases, bar_on_plate) {
    Trial trial;
    const auto bar = box(0.1, 0.1, 1), plate = box(0.1003, 0.08, 0.0003);
    for (const double perturbations : {-5.0, -1.0, 0.0, 0.5, 1.0, 1.2, 1.5, 1.8, 2.0, 2.2, 3.0, 5.0, 10.0, 100.0}) {
        Case c{
            "a bar on a plate, overlap " + text(perturbations) + " perturbations", bar, plate, {}, Answer::either, 0};
        const double overlap = perturbations * perturbation(c);
        c.pose_b = at(0, 0, 1.0003 - overlap);
        c.answer = answer_for(c, overlap);
        c.deepest = std::max(1.0001 * overlap + perturbation(c), touching * perturbation(c));
        trial.ask(c);
    }
}

TEST(exact_cases, shared_faces) {
    Trial trial;
    const auto cube = box(0.5, 0.5, 0.5), small = box(0.25, 0.25, 0.25), plate = box(2, 2, 0.05);
    const auto prism = Shape::make(prism_solid(6, 0.5, 0.5));
    const auto ask = [&](const char* name, const ShapePtr& a, const ShapePtr& b, const Pose& pose) {
        Case c{name, a, b, pose, Answer::either, 0};
        c.deepest = touching * perturbation(c);
        trial.ask(c);
    };
    ask("a cube on a cube", cube, cube, at(0, 0, 1));
    ask("a cube on a cube, half over the edge", cube, cube, at(0.5, 0, 1));
    ask("a cube on a cube, a quarter each way", cube, cube, at(0.25, 0.25, 1));
    ask("cubes that share an edge", cube, cube, at(1, 0, 1));
    ask("cubes that share a corner", cube, cube, at(1, 1, 1));
    ask("a small cube on a cube", cube, small, at(0, 0, 0.75));
    ask("a small cube in the corner of a cube's face", cube, small, at(0.25, 0.25, 0.75));
    ask("a cube on a plate", plate, cube, at(0.1, 0.2, 0.55));
    ask("a turned cube on a plate", plate, cube, about_z(0.4, {0.1, 0.2, 0.55}));
    ask("prisms end to end", prism, prism, at(0, 0, 1));
    ask("a prism on a cube", cube, prism, at(0.1, 0, 1));
    // From inside, too, touching is a matter of a perturbation: the smaller lies in the larger, whole.
    for (const Vec3& where : {Vec3{0, 0, 0.25}, Vec3{0.25, 0, 0.25}, Vec3{0.25, 0.25, 0.25}}) {
        Case c{"a small cube in a cube, at its wall", cube, small, {}, Answer::yes, 0.76};
        c.pose_b.translation = where;
        trial.ask(c);
    }
    Case c{"a cube whose hole a box fills",
           Shape::make(frame_mesh()),
           box(0.375, 0.375, 0.125),
           at(0, 0, 0.125),
           Answer::either,
           0};
    c.deepest = touching * perturbation(c);
    trial.ask(c);
}

TEST(exact_cases, parallel_edges) {
    Trial trial;
    const double half = 0.5, diagonal = half * std::sqrt(2.0);
    const auto cube = box(half, half, half);
    Pose turned = about_z(1, {});
    for (const double overlap : {-1e-3, -1e-5, -1e-8, 0.0, 1e-8, 1e-5, 1e-4, 1e-3, 0.01, 0.1})
        for (const double along : {0.0, 1e-8, 1e-3, 0.3}) {
            // A cube's upright edge against a face of the other, and against its upright edge.
            for (const bool edges : {false, true}) {
                Case c{std::string("an edge along ") + (edges ? "an edge" : "a face") + ", overlap " + text(overlap)
                           + ", along " + text(along),
                       cube,
                       cube,
                       turned,
                       Answer::either,
                       0};
                if (edges) {
                    // The other's own edge looks along x = y; so does the way between them.
                    c.pose_b = at(2 * half - overlap, 2 * half - overlap, along);
                } else {
                    c.pose_b.translation = {half + diagonal - overlap, 0.1, along};
                }
                c.answer = answer_for(c, overlap);
                // A piece of an edge can be as long as the wedge is wide.
                c.deepest = std::max(1.5 * overlap + 1e-6, touching * perturbation(c));
                trial.ask(c);
            }
        }
}

} // namespace
