// SPDX-License-Identifier: Apache-2.0
// Balls and capsules as bodies of a scene: their contacts against closed forms and brute force, and what they must not
// feel.
#include <raycontact/collide.h>
#include <raycontact/primitives.h>
#include <raycontact/scene.h>

#include "reference/meshes.h"
#include "reference/random.h"
#include "unit/query/placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;
using ShapePtr = std::shared_ptr<const Shape>;

/// Turned about y, so that a capsule's axis is x.
Pose lying(const Vec3& place) {
    return {{0, 0, 1, 0, 1, 0, -1, 0, 0}, place};
}
Settings settings_with(bool speculative, const char* devices = "cpu") {
    Settings settings;
    settings.speculative = speculative ? Speculative::on : Speculative::off;
    settings.execution.devices = devices;
    return settings;
}

/// Points all along the axis, world frame.
std::vector<Vec3> axis_of(const Shape& shape, const Pose& pose) {
    const Round& round = *shape.round();
    constexpr int parts = 400;
    std::vector<Vec3> points;
    for (int i = 0; i <= parts; ++i)
        points.push_back(transform_point(pose, round.from + (double(i) / parts) * (round.to - round.from)));
    return points;
}
double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double square = length2(b - a), part = square > 0 ? std::clamp(dot(p - a, b - a) / square, 0.0, 1.0) : 0;
    return length(p - (a + part * (b - a)));
}
double between_rounds(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const Vec3 from = transform_point(pose_b, b.round()->from), to = transform_point(pose_b, b.round()->to);
    double least = 1e30;
    for (const Vec3& p : axis_of(a, pose_a)) least = std::min(least, to_segment(p, from, to));
    return least - a.round()->radius - b.round()->radius;
}
float deepest(std::span<const Contact> contacts) {
    float depth = -1e30f;
    for (const Contact& c : contacts) depth = std::max(depth, c.depth);
    return depth;
}
/// What holds of every contact with a round body.
void expect_sound(std::span<const Contact> contacts) {
    std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint64_t>> keys;
    for (const Contact& c : contacts) {
        EXPECT_EQ(c.feature.kind, FeatureKind::round);
        EXPECT_NEAR(length(Vec3(c.normal)), 1, 1e-6);
        EXPECT_LT(length((c.point_a - c.point_b) - double(c.depth) * Vec3(c.normal)), 1e-9);
        EXPECT_EQ(std::fabs(c.depth), c.ray_length);
        EXPECT_EQ(c.weight, 1);
        EXPECT_TRUE(keys.insert({c.body_a.slot, c.body_b.slot, c.key()}).second);
    }
}

TEST(RoundBodies, TwoAreAsDeepAsTheirDistanceIsNegative) {
    Random random(11);
    const std::vector<ShapePtr> shapes{make_ball(0.4), make_ball(0.1), make_capsule(0.2, 0.5), make_capsule(0.05, 1.2)};
    int touching = 0;
    for (int i = 0; i < 4000; ++i) {
        const ShapePtr &a = shapes[random.below(4)], &b = shapes[random.below(4)];
        const Pose pose_a = anywhere(random, 0.5), pose_b = anywhere(random, 0.5);
        const std::vector<Contact> contacts = collide(*a, pose_a, *b, pose_b);
        const double apart = between_rounds(*a, pose_a, *b, pose_b);
        if (std::fabs(apart) < 5e-3) continue; // by points
        ASSERT_EQ(contacts.empty(), apart > 0) << i;
        if (contacts.empty()) continue;
        ++touching;
        expect_sound(contacts);
        ASSERT_NEAR(double(deepest(contacts)), -apart, 5e-3) << i;
        for (const Contact& c : contacts) {
            EXPECT_EQ(c.feature.source, Side::a);
            EXPECT_EQ(c.feature.index_b, ContactFeature::no_index);
            const auto on = [&](const Shape& shape, const Pose& pose, const Vec3& p) {
                return closest_point(shape, pose, p)->distance;
            };
            const double off = contacts.size() > 1 ? 2e-3 * a->round()->radius : 1e-6;
            EXPECT_LT(on(*a, pose_a, c.point_a), off);
            EXPECT_LT(on(*b, pose_b, c.point_b), off);
        }
    }
    EXPECT_GT(touching, 1500);
}

TEST(RoundBodies, CapsulesBesideEachOtherTouchAtBothEnds) {
    const ShapePtr log = make_capsule(0.1, 0.5), branch = make_capsule(0.1, 0.2);
    const auto places = [](const std::vector<Contact>& contacts) {
        std::vector<double> x;
        for (const Contact& c : contacts) x.push_back(c.point_a.x);
        std::ranges::sort(x);
        return x;
    };
    for (const double slope : {0.0, 1e-9, 1e-4, 0.01}) {
        // the world in which `tilt` is no turn sees what lies in the upper one's frame
        const Pose upper = relative_pose(small_rotation({0, 1, 0}, slope), lying({0, 0, 0.19}));
        const auto contacts = collide(*log, lying({0, 0, 0}), *branch, upper);
        ASSERT_EQ(contacts.size(), 2u) << slope;
        EXPECT_NEAR(places(contacts)[0], -0.2, 0.01);
        EXPECT_NEAR(places(contacts)[1], 0.2, 0.01);
        EXPECT_NEAR(double(contacts[0].depth + contacts[1].depth), 0.02, 1e-3);
        for (const Contact& c : contacts) EXPECT_GT(c.normal.z, 0.999f);
    }
    // What goes on beyond the other's end; end to end; across; at the same place.
    EXPECT_EQ(places(collide(*log, lying({}), *log, lying({0.6, 0, 0.19}))).size(), 2u);
    const auto behind = collide(*log, lying({}), *branch, lying({0.85, 0, 0}));
    ASSERT_EQ(behind.size(), 1u);
    EXPECT_NEAR(double(behind[0].normal.x), 1, 1e-6);
    EXPECT_NEAR(double(behind[0].depth), 0.05, 1e-6);
    const auto crossing = collide(*log, lying({}), *log, {{1, 0, 0, 0, 0, 1, 0, -1, 0}, {0.1, 0, 0.19}});
    ASSERT_EQ(crossing.size(), 1u);
    EXPECT_NEAR(crossing[0].point_a.x, 0.1, 1e-9);
    for (const ShapePtr& shape : {log, make_ball(0.3)}) {
        const auto same = collide(*shape, lying({}), *shape, lying({}));
        ASSERT_EQ(same.size(), 1u);
        EXPECT_NEAR(double(same[0].depth), 2 * shape->round()->radius, 1e-6);
        EXPECT_NEAR(double(same[0].normal.x), 0, 1e-6) << "across";
    }
}

TEST(RoundBodies, DeepestOnAMeshIsTheDistance) {
    Random random(12);
    const std::vector<ShapePtr> rounds{make_ball(0.3), make_ball(0.05), make_capsule(0.1, 0.4)},
        meshes{Shape::make(box_mesh({0.5, 0.3, 0.2})), Shape::make(bumpy_octahedron_mesh(3))};
    int touching = 0;
    for (int i = 0; i < 1500; ++i) {
        const ShapePtr &round = rounds[random.below(3)], &mesh = meshes[random.below(2)];
        const Pose pose = anywhere(random, 1.2), place = anywhere(random, 0.3);
        const bool mesh_first = random.below(2) == 0;
        const auto contacts = mesh_first ? collide(*mesh, place, *round, pose) : collide(*round, pose, *mesh, place);
        double least = 1e30;
        bool deep = false; // the axis is in the mesh: the way out is not the distance
        for (const Vec3& p : axis_of(*round, pose)) {
            least = std::min(least, closest_point(*mesh, place, p)->distance);
            deep = deep || contains(*mesh, place, p);
        }
        const double apart = least - round->round()->radius;
        if (!deep && std::fabs(apart) < 1e-3) continue;
        ASSERT_EQ(contacts.empty(), !deep && apart > 0) << i;
        if (contacts.empty()) continue;
        ++touching;
        expect_sound(contacts);
        if (!deep) {
            ASSERT_NEAR(double(deepest(contacts)), -apart, 1e-3) << i;
        }
        for (const Contact& c : contacts) {
            EXPECT_EQ(c.feature.source, mesh_first ? Side::b : Side::a);
            EXPECT_LT(c.feature.other_index(), mesh->triangles().size());
            EXPECT_LT(closest_point(*mesh, place, mesh_first ? c.point_a : c.point_b)->distance, 1e-6);
        }
    }
    EXPECT_GT(touching, 300);
}

// A floor of tiles, some of which are a little lower, is one surface: whatever lies or goes on it feels it as a plane.
TEST(RoundBodies, RollOverSeamsAsOverAPlane) {
    for (const bool speculative : {false, true}) {
        Scene scene(settings_with(speculative));
        const ShapePtr tile = make_box({0.5, 0.5, 0.1});
        for (int i = -3; i <= 3; ++i)
            for (int k = -3; k <= 3; ++k)
                scene.add(tile, at({double(i), double(k), -0.1 - ((i + k) % 2 == 0 ? 0 : 1e-5)}));
        const BodyId ball = scene.add(make_ball(0.2)), capsule = scene.add(make_capsule(0.15, 0.3));
        int found = 0;
        for (int i = 0; i < 400; ++i) {
            const double x = -1.6 + 0.008 * i;
            scene.set_pose(ball, at({x, 0.37 * x, 0.2 - 2e-4}));
            scene.set_pose(capsule, lying({x, -0.8 + 0.21 * x, 0.15 - 2e-4}));
            scene.find_contacts();
            for (const BodyId body : {ball, capsule}) {
                std::size_t own = 0;
                for (const Contact& c : scene.contacts()) {
                    if (c.body_a != body && c.body_b != body) continue;
                    ++own;
                    EXPECT_GT(std::fabs(c.normal.z), 1 - 1e-6f) << i << ' ' << speculative;
                    EXPECT_NEAR(double(c.depth), 2e-4, 1.1e-5) << i;
                }
                EXPECT_GE(own, body == ball ? 1u : 2u) << i;
                EXPECT_LE(own, body == ball ? 4u : 8u) << i; // where tiles meet each has one
                found += int(own);
            }
        }
        EXPECT_GT(found, 1200);
    }
}

// A step asks only about what moved; what a round body meets is one surface, so it asks about all of that.
TEST(RoundBodies, AStepThatAsksFewFindsWhatAFreshSceneFinds) {
    Random random(13);
    const std::vector<ShapePtr> shapes{make_ball(0.35), make_capsule(0.15, 0.4), make_box({0.5, 0.5, 0.1}),
                                       Shape::make(bumpy_octahedron_mesh(2))};
    for (const char* devices : {"cpu", "cpu/0,cpu/1"}) {
        Scene scene(settings_with(false, devices));
        std::vector<BodyId> bodies;
        const auto place = [&](std::size_t i) { // pairs of tiles lie beside each other
            return i % 4 == 2 ? at({double(random.below(4)), double(random.below(4)), 0.1 * random.below(2)})
                              : anywhere(random, 3);
        };
        for (std::size_t i = 0; i < 80; ++i) bodies.push_back(scene.add(shapes[i % 4], place(i)));
        for (std::size_t i = 0; i < 80; i += 9) scene.set_sensor(bodies[i], true);
        std::size_t count = 0, lost = 0;
        for (int step = 0; step < 120; ++step) {
            for (int k = 0; k < 4; ++k) {
                const std::size_t i = random.below(80);
                if (random.below(6) == 0) {
                    scene.remove(bodies[i]);
                    bodies[i] = scene.add(shapes[(i + random.below(2)) % 4], place(i));
                } else if (random.below(8) == 0) {
                    scene.set_sensor(bodies[i], !scene.is_sensor(bodies[i]));
                } else if (random.below(8) == 0) {
                    scene.set_filter(bodies[i], 1 + random.below(2), 1 + random.below(3));
                } else {
                    scene.set_pose(bodies[i], place(i));
                }
            }
            scene.find_contacts();
            lost += scene.lost_contacts().size();
            Scene fresh(settings_with(false));
            std::vector<BodyId> same;
            for (const BodyId body : scene.bodies()) {
                while (same.size() < body.slot) same.push_back(fresh.add(shapes[0], at({99, 0, 0}))); // an empty slot
                same.push_back(fresh.add(scene.shape(body).shared_from_this(), scene.pose(body)));
                fresh.set_sensor(same.back(), scene.is_sensor(body));
            }
            const auto open = scene.pairs();
            std::vector<Pair> pairs;
            for (const auto& [a, b] : open) pairs.emplace_back(same[a.slot], same[b.slot]);
            fresh.find_contacts(pairs);
            ContactHash own, wanted;
            own.add(0, scene.contacts());
            wanted.add(0, fresh.contacts());
            ASSERT_EQ(own.hex(), wanted.hex()) << devices << ", step " << step;
            count += scene.contacts().size();
        }
        EXPECT_GT(count, 3000u);
        EXPECT_GT(lost, 300u);
    }
}

TEST(RoundBodies, HaveTheSameContactsByEveryMethodAndOnEveryPart) {
    const auto run = [](Method method, const char* devices, std::uint32_t threads) {
        Settings settings = settings_with(true, devices);
        settings.method = method;
        settings.execution.threads = threads;
        Scene scene(settings);
        Random random(14);
        const ShapePtr ball = make_ball(0.3), capsule = make_capsule(0.2, 0.3),
                       ring = Shape::make(bumpy_octahedron_mesh(3));
        std::vector<Vec3> ways;
        std::vector<Pose> poses;
        std::vector<BodyId> bodies;
        for (std::size_t i = 0; i < 60; ++i) {
            poses.push_back(anywhere(random, 2));
            ways.push_back(0.1 * random.in_ball());
            bodies.push_back(scene.add(i % 3 == 0 ? ball : i % 3 == 1 ? capsule : ring, poses.back()));
        }
        ContactHash hash(settings.direction, true);
        std::vector<Contact> round;
        for (std::uint32_t step = 0; step < 20; ++step) {
            for (std::size_t i = 0; i < bodies.size(); ++i) {
                poses[i].translation += ways[i];
                if (length(poses[i].translation) > 2) ways[i] = -0.05 * poses[i].translation;
                scene.set_pose(bodies[i], poses[i]);
            }
            scene.find_contacts();
            round.clear();
            for (const Contact& c : scene.contacts())
                if (c.feature.kind == FeatureKind::round) round.push_back(c);
            hash.add(step, round);
        }
        EXPECT_GT(round.size(), 20u);
        return hash.hex();
    };
    const std::string first = run(Method::certified, "cpu", 1);
    EXPECT_EQ(run(Method::certified, "cpu", 2), first);
    EXPECT_EQ(run(Method::certified, "cpu/0,cpu/1", 2), first);
    EXPECT_EQ(run(Method::standard, "cpu", 2), first);
    EXPECT_EQ(run(Method::iterative, "cpu/0,cpu/1", 1), first);
    EXPECT_EQ(run(Method::predictive, "cpu", 1), first);
}

// Two that go straight have a contact where they come together, and none where they pass each other.
TEST(RoundBodies, OfTwoThatMoveWhatMeetsIsTold) {
    Random random(15);
    const std::vector<ShapePtr> shapes{make_ball(0.2), make_capsule(0.1, 0.4)};
    int met = 0, passed = 0;
    for (int i = 0; i < 8000; ++i) {
        const ShapePtr &a = shapes[random.below(2)], &b = shapes[random.below(2)];
        Settings settings = settings_with(true);
        settings.speculative_margin = 0.01;
        Scene scene(settings);
        const Pose pose_a = anywhere(random, 0.5), pose_b = anywhere(random, 1.5);
        const Vec3 way = 0.6 * random.direction();
        const BodyId first = scene.add(a, pose_a), second = scene.add(b, pose_b);
        scene.set_next_pose(second, {pose_b.rotation, pose_b.translation + way});
        const auto contacts = scene.find_contacts();
        double least = 1e30, start = between_rounds(*a, pose_a, *b, pose_b);
        if (start < 0.012) continue; // they touch, or are near
        for (int k = 0; k <= 60; ++k)
            least = std::min(least,
                             between_rounds(*a, pose_a, *b, {pose_b.rotation, pose_b.translation + (k / 60.0) * way}));
        if (least < -0.01) {
            ++met;
            ASSERT_FALSE(contacts.empty()) << i;
            ASSERT_LE(contacts.size(), 3u) << i;
            for (const Contact& c : contacts) {
                EXPECT_EQ(c.body_a, first);
                EXPECT_TRUE(c.is_speculative());
                EXPECT_GT(dot(Vec3(c.normal), Vec3(contacts[0].normal)), 0) << "they are on one side";
            }
            // A solver that keeps the gap from closing stops them no later than where they touch.
            EXPECT_TRUE(std::ranges::any_of(contacts, [&](const Contact& c) {
                return dot(way, Vec3(c.normal)) <= double(c.depth) + 1e-6 && -double(c.depth) <= start + 1e-6;
            })) << i;
        } else if (least > 0.01) {
            ++passed;
            ASSERT_TRUE(contacts.empty()) << i;
        }
    }
    EXPECT_GT(met, 200);
    EXPECT_GT(passed, 600);
}

TEST(RoundBodies, AStepIsAWallHoweverWideTheMargin) {
    for (const double margin : {0.001, 0.05, 0.5}) {
        Settings settings = settings_with(true);
        settings.speculative_margin = margin;
        Scene scene(settings);
        scene.add(make_box({2, 2, 0.5}), at({0, 0, -0.5}));
        const BodyId step = scene.add(make_box({1, 2, 0.5}), at({1, 0, -0.46}));
        const double touch = std::sqrt(0.01 - 0.06 * 0.06); // along the floor, from the edge
        const BodyId ball = scene.add(make_ball(0.1), at({-touch + 1e-3, 0.3, 0.1}));
        scene.find_contacts();
        double edge = 0;
        for (const Contact& c : scene.contacts(step, ball)) edge = std::max(edge, double(-c.normal.x));
        EXPECT_NEAR(edge, 0.8, 0.01) << margin;
    }
}

TEST(RoundBodies, FastOnesAreStoppedByGroundWallsAndSheets) {
    Settings settings = settings_with(true);
    for (const ShapePtr& wall : {make_box({2, 2, 0.01}), Shape::make(sheet_mesh(4))}) {
        Scene scene(settings);
        scene.add(wall);
        const BodyId ball = scene.add(make_ball(0.05), at({0.13, 0.11, 0.3}));
        scene.set_next_pose(ball, at({0.13, 0.11, -0.3}));
        const auto contacts = scene.find_contacts();
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_TRUE(contacts[0].is_speculative());
        EXPECT_LT(-contacts[0].depth, 0.26f);
        EXPECT_LT(contacts[0].normal.z * (contacts[0].body_b == ball ? -1 : 1), -0.5f);
    }
}

/// Contacts of a body that is expected elsewhere.
std::vector<Contact> ahead(Scene& scene, BodyId body, const Vec3& way) {
    const Pose pose = scene.pose(body);
    scene.set_next_pose(body, {pose.rotation, pose.translation + way});
    scene.find_contacts();
    std::vector<Contact> own;
    for (const Contact& c : scene.contacts())
        if (c.body_a == body || c.body_b == body) own.push_back(c);
    return own;
}

// However near the ground is that they roll on, and whatever margin another body has.
TEST(RoundBodies, WhatTheyWillTouchIsToldBesideWhatTheyPass) {
    const double slope = std::tan(20 * std::numbers::pi / 180), z = 2 * slope;
    Mesh mesh;
    mesh.vertices = {{-2, -1, 0}, {0, -1, 0}, {2, -1, z}, {-2, 1, 0}, {0, 1, 0}, {2, 1, z}};
    mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    for (const double gap : {5e-4, 2e-4, 1e-3}) {
        Scene scene(settings_with(true));
        scene.add(Shape::make(mesh));
        const double x = -0.2 * std::tan(10 * std::numbers::pi / 180) - 0.02; // 2 cm before the ramp
        const BodyId ball = scene.add(make_ball(0.2), at({x, 0.13, 0.2 + gap}));
        const auto contacts = ahead(scene, ball, {0.2, 0, -0.002});
        EXPECT_TRUE(std::ranges::any_of(contacts, [](const Contact& c) { return std::fabs(c.normal.x) > 0.3f; }))
            << gap;
    }
    for (const bool wide : {false, true}) {
        Scene scene(settings_with(true));
        scene.add(make_box({2, 2, 0.05}), at({0, 0, -0.05}));
        const BodyId other = scene.add(make_box({0.1, 0.1, 0.1}), at({0.5, 0, 0.5}));
        if (wide) scene.set_speculative_margin(other, 1.0);
        const BodyId ball = scene.add(make_ball(0.1), at({0, 0, 0.4}));
        const auto contacts = ahead(scene, ball, {0, 0, -0.8});
        EXPECT_TRUE(std::ranges::any_of(contacts, [](const Contact& c) { return c.body_a.slot == 0; })) << wide;
    }
}

TEST(RoundBodies, SeamsThatTheyCrossBeforeTheyTouchHideNothing) {
    for (const bool tiles : {false, true}) {
        const auto add_floor = [&](Scene& scene) {
            if (!tiles) scene.add(make_box({1, 0.5, 0.1}), at({0, 0, -0.1}));
            for (const double x : {-0.5, 0.5})
                if (tiles) scene.add(make_box({0.5, 0.5, 0.1}), at({x, 0, -0.1}));
        };
        const auto count = [&](const ShapePtr& shape, const Pose& pose, double far, double down) {
            Scene scene(settings_with(true));
            add_floor(scene);
            return ahead(scene, scene.add(shape, pose), {far, 0, -down}).size();
        };
        for (const double down : {0.003, 0.0095}) {
            EXPECT_EQ(count(make_ball(0.2), at({-0.005, 0, 0.2001}), 0.4, down), 1u) << tiles;
            EXPECT_EQ(count(make_capsule(0.2, 0.3), {{1, 0, 0, 0, 0, 1, 0, -1, 0}, {-0.005, 0, 0.2001}}, 0.4, down),
                      2u);
            EXPECT_EQ(count(make_capsule(0.2, 0.1), lying({-0.105, 0, 0.2001}), 0.4, down), 2u) << tiles;
        }
        // At a very small angle, too.
        for (const double down : {1.5e-4, 2.5e-4, 4.5e-4, 5.5e-4})
            EXPECT_GE(count(make_ball(0.2), at({-0.3, 0, 0.2001}), 0.5, down), 1u) << tiles << ' ' << down;
    }
}

TEST(RoundBodies, KeysStayInAGrooveWhateverTheTriangles) {
    for (const double steep : {2.0, 0.3}) {
        Mesh mesh; // strips of triangles, now the left side first, now the right one
        constexpr std::uint32_t strips = 40;
        for (std::uint32_t i = 0; i <= strips; ++i)
            for (const double x : {-1.0, 0.0, 1.0}) mesh.vertices.push_back({x, 0.1 * i, steep * std::fabs(x)});
        for (std::uint32_t i = 0; i < strips; ++i)
            for (const std::uint32_t side : {i % 2, 1 - i % 2}) {
                const std::uint32_t a = 3 * i + side;
                mesh.triangles.push_back({a, a + 1, a + 4});
                mesh.triangles.push_back({a, a + 4, a + 3});
            }
        Scene scene(settings_with(false));
        scene.add(Shape::make(mesh));
        const double height = (0.3 - 1e-3) * std::hypot(1, steep);
        const BodyId ball = scene.add(make_ball(0.3), at({0, 0.5, height}));
        std::vector<std::uint64_t> keys(2); // left, right
        for (int step = 0; step < 300; ++step) {
            scene.set_pose(ball, at({0, 0.5 + 0.01 * step, height}));
            scene.find_contacts();
            ASSERT_EQ(scene.contacts().size(), 2u);
            for (const Contact& c : scene.contacts()) {
                std::uint64_t& key = keys[c.normal.x > 0 ? 0 : 1];
                EXPECT_EQ(c.is_new, step == 0);
                if (step > 0) {
                    EXPECT_EQ(c.key(), key) << step;
                }
                key = c.key();
            }
        }
    }
}

// An end that is near says nothing of the other one, which swings in.
TEST(RoundBodies, ACapsuleThatTurnsOntoAnotherIsStoppedAtBothEnds) {
    const ShapePtr log = make_capsule(0.05, 0.5);
    for (const double gap : {3e-4, 5e-3}) {
        Scene scene(settings_with(true));
        scene.add(log, lying({0, 0, 0}));
        const auto turned = [&](double angle) { // about the end at the left
            const double c = std::cos(angle), s = std::sin(angle);
            return Pose{{s, 0, c, 0, 1, 0, -c, 0, s}, Vec3{-0.45, 0, 0.1 + gap} + 0.5 * Vec3{c, 0, s}};
        };
        const BodyId body = scene.add(log, turned(0.2));
        scene.set_next_pose(body, turned(-0.2));
        double left = 1, right = -1;
        for (const Contact& c : scene.find_contacts()) {
            EXPECT_GT(c.normal.z, 0.8f);
            left = std::min(left, c.point_a.x);
            right = std::max(right, c.point_a.x);
        }
        if (gap < 1e-3) {
            EXPECT_LT(left, -0.4) << gap;
        }
        EXPECT_GT(right, 0.35) << gap;
    }
}

TEST(RoundBodies, ACapsuleLiesOnBothEdgesOfABeam) {
    for (const double tilt : {0.0, 1e-7, 1e-5, 1e-3}) {
        const Pose pose = relative_pose(small_rotation({0, 1, 0}, tilt), lying({0, 0, 0.099}));
        const auto contacts = collide(*make_box({0.1, 1, 0.1}), at({0, 0, -0.1}), *make_capsule(0.1, 0.5), pose);
        double left = 1, right = -1;
        for (const Contact& c : contacts) {
            left = std::min(left, c.point_a.x);
            right = std::max(right, c.point_a.x);
        }
        EXPECT_NEAR(left, -0.1, 1e-3) << tilt;
        EXPECT_NEAR(right, 0.1, 1e-3) << tilt;
    }
}

// What is tolerated grows with the mesh, and must not become as wide as what lies in it is.
TEST(RoundBodies, AThinOneOverACurbOfALargeMeshIsOnlyThere) {
    for (const double extent : {5.0, 500.0, 5000.0}) {
        Mesh mesh = box_mesh({extent, extent, 1});
        for (Vec3& v : mesh.vertices) v.z -= 1;
        Mesh curb = box_mesh({0.02, 0.5, 0.05});
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3& v : curb.vertices) mesh.vertices.push_back({v.x, v.y, v.z + 0.05});
        for (const auto& [a, b, c] : curb.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
        const auto ground = Shape::make(mesh);
        double top = 0; // as float32 has it
        for (const Vec3& v : ground->vertices()) top = std::max(top, v.z);
        const auto contacts = collide(*ground, {}, *make_capsule(0.0008, 0.1), lying({0, 0.01, top + 0.0007}));
        EXPECT_EQ(contacts.size(), 2u) << extent << ": at either edge";
        for (const Contact& c : contacts) EXPECT_NEAR(double(c.depth), 1e-4, 2e-5) << extent;
    }
}

TEST(RoundBodies, SensorsFeelThemAndDoNotStopThem) {
    Scene scene(settings_with(false));
    const ShapePtr ball = make_ball(0.3), box = make_box({1, 1, 0.5});
    scene.add(box, at({0, 0, -0.5}));
    const BodyId zone = scene.add(box, at({1, 0, -0.45}));
    scene.set_sensor(zone, true);
    const BodyId own = scene.add(ball, at({0.5, 0, 0.29}));
    scene.find_contacts();
    ASSERT_EQ(scene.contacts().size(), 1u) << "the zone's surface is higher, and no floor";
    EXPECT_EQ(scene.contacts()[0].body_b, own);
    EXPECT_EQ(scene.contacts()[0].body_a.slot, 0u);
    EXPECT_NEAR(double(scene.contacts()[0].depth), 0.01, 1e-6);
    ASSERT_EQ(scene.touching().size(), 3u) << "floor and zone, too";
    EXPECT_EQ(std::ranges::count_if(scene.touching(), &Touch::sensor), 2);
    scene.set_pose(own, at({0.5, 0, 2}));
    scene.find_contacts();
    EXPECT_EQ(scene.ended().size(), 2u);
    EXPECT_EQ(scene.lost_contacts().size(), 1u);
    EXPECT_EQ(scene.lost_contacts()[0].feature.kind, FeatureKind::round);
    EXPECT_EQ(scene.lost_contacts()[0].feature.source, Side::b);
    EXPECT_EQ(scene.lost_contacts()[0].feature.source_index() / 27, 0u);
    EXPECT_EQ(scene.lost_contacts()[0].feature.other_index(), ContactFeature::no_index);
}

TEST(RoundBodies, WeighTheDiscThatThePlaneCuts) {
    CollideOptions options;
    options.direction = Direction::weighted;
    for (const double depth : {0.01, 0.1, 0.4}) {
        const auto contacts = collide(*make_box({2, 2, 1}), {}, *make_ball(0.5), at({0.2, 0.3, 1.5 - depth}), options);
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_EQ(contacts[0].feature.kind, FeatureKind::round);
        EXPECT_NEAR(double(contacts[0].weight), std::numbers::pi * (depth - depth * depth), 1e-6);
    }
}

TEST(RoundBodies, MayBeOfAnySizeAndFarAway) {
    for (const double scale : {1e-3, 1.0, 1e4})
        for (const Vec3& origin : {Vec3{}, 1e4 * scale * Vec3{1, -2, 3}}) {
            const auto on_box = collide(*make_box(scale * Vec3{1, 1, 0.5}), at(origin), *make_ball(0.2 * scale),
                                        at(origin + scale * Vec3{0.3, 0.1, 0.69}));
            ASSERT_EQ(on_box.size(), 1u) << scale;
            EXPECT_NEAR(double(on_box[0].depth), 0.01 * scale, 1e-6 * scale);
            const auto balls = collide(*make_ball(0.2 * scale), at(origin), *make_capsule(0.2 * scale, scale),
                                       at(origin + scale * Vec3{0.3, 0.2, 0.5}));
            ASSERT_EQ(balls.size(), 1u);
            EXPECT_NEAR(double(balls[0].depth), (0.4 - std::sqrt(0.13)) * scale, 1e-6 * scale);
        }
}

} // namespace
} // namespace raycontact
