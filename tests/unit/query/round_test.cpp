// SPDX-License-Identifier: Apache-2.0
// Balls and capsules in every query: against closed forms, and against points and triangles tried one by one.
#include <raycontact/clash.h>
#include <raycontact/collide.h>
#include <raycontact/error.h>
#include <raycontact/primitives.h>
#include <raycontact/scene.h>
#include <raycontact/separation.h>

#include "brute_force.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "unit/query/placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;
using ShapePtr = std::shared_ptr<const Shape>;

double apart(const Vec3& p, const Vec3& q) {
    return length(p - q);
}

/// The least of a convex function from 0 to 1.
template <class Of>
double least_of(Of&& of) {
    double low = 0, high = 1;
    for (int i = 0; i < 90; ++i) {
        const double p = low + (high - low) / 3, q = high - (high - low) / 3;
        (of(p) < of(q) ? high : low) = of(p) < of(q) ? q : p;
    }
    return of(0.5 * (low + high));
}
Vec3 on_axis(const Shape& shape, const Pose& pose, double t) {
    const Round& round = *shape.round();
    return transform_point(pose, round.from + t * (round.to - round.from));
}
double to_surface(const Shape& shape, const Pose& pose, const Vec3& point) {
    return least_of([&](double t) { return apart(on_axis(shape, pose, t), point); }) - shape.round()->radius;
}
double between_round(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const double axes = least_of([&](double s) {
        const Vec3 point = on_axis(a, pose_a, s);
        return least_of([&](double t) { return apart(point, on_axis(b, pose_b, t)); });
    });
    return axes - a.round()->radius - b.round()->radius;
}
/// Of the axis from the surface of a mesh, less the radius.
double to_mesh(const Shape& round, const Pose& pose, const std::vector<brute::Triangle>& mesh) {
    double least = std::numeric_limits<double>::infinity();
    const Vec3 from = on_axis(round, pose, 0), to = on_axis(round, pose, 1), middle = 0.5 * (from + to);
    for (const brute::Triangle& triangle : mesh) {
        if (brute::distance(middle, triangle) - 0.5 * apart(from, to) >= least) continue;
        least = std::min(least, least_of([&](double t) { return brute::distance(on_axis(round, pose, t), triangle); }));
    }
    return least - round.round()->radius;
}

const std::vector<ShapePtr>& round_shapes() {
    static const std::vector<ShapePtr> shapes{make_ball(0.4), make_ball(0.05), make_capsule(0.2, 0.5),
                                              make_capsule(0.02, 1.5), make_capsule(0.6, 0.01)};
    return shapes;
}

TEST(Primitives, RoundOnesAreWhatTheySay) {
    const ShapePtr ball = make_ball(0.3), capsule = make_capsule(0.3, 1.7);
    ASSERT_NE(ball->round(), nullptr);
    EXPECT_EQ(ball->round()->from, ball->round()->to);
    EXPECT_EQ(ball->radius(), 0.3);
    EXPECT_EQ(ball->box_max(), (Vec3{0.3, 0.3, 0.3}));
    EXPECT_EQ(capsule->box_min(), (Vec3{-0.3, -0.3, -2}));
    EXPECT_EQ(capsule->radius(), 2);
    EXPECT_EQ(Shape::make(box_mesh({1, 1, 1}))->round(), nullptr);
    for (const ShapePtr& shape : round_shapes()) {
        EXPECT_TRUE(shape->has_inside());
        EXPECT_TRUE(verdict_of(shape->report()).good) << verdict_of(shape->report()).text;
        double lowest = 1, highest = -1;
        for (const Vec3& v : shape->vertices()) {
            EXPECT_NEAR(to_surface(*shape, {}, v), 0, 1e-6);
            lowest = std::min(lowest, v.x);
            highest = std::max(highest, v.y);
        }
        EXPECT_NEAR(lowest, -shape->round()->radius, 1e-7);
        EXPECT_NEAR(highest, shape->round()->radius, 1e-7);
    }
}

TEST(Primitives, MassIsThatOfTheBodyNotOfItsPicture) {
    // Rings of the body, summed up finely.
    const Round round{{0.3, 0.1, -0.2}, {0.3, 0.9, -0.2}, 0.4};
    const Mass mass = mass_of(round);
    double volume = 0, along = 0, across = 0;
    constexpr int slices = 20000;
    for (int i = 0; i < slices; ++i) {
        const double y = 1.6 * ((i + 0.5) / slices - 0.5), over = std::max(std::fabs(y) - 0.4, 0.0);
        const double square = 0.16 - over * over, slice = std::acos(-1) * square * 1.6 / slices;
        volume += slice;
        along += slice * square / 2;
        across += slice * (square / 4 + y * y);
    }
    EXPECT_NEAR(mass.volume, volume, 1e-7);
    EXPECT_LT(apart(mass.centre, {0.3, 0.5, -0.2}), 1e-15);
    EXPECT_NEAR(mass.inertia[4], along, 1e-7);
    EXPECT_NEAR(mass.inertia[0], across, 1e-7);
    EXPECT_NEAR(mass.inertia[8], across, 1e-7);
    EXPECT_NEAR(mass.inertia[1], 0, 1e-15);
    const Mass ball = mass_of({{}, {}, 0.5});
    EXPECT_NEAR(ball.inertia[0], 0.4 * ball.volume * 0.25, 1e-15);
    EXPECT_EQ(ball.inertia[0], ball.inertia[8]);
}

TEST(Primitives, OthersAreExactMeshes) {
    const ShapePtr box = make_box({0.1, 0.2, 0.3}), plane = make_plane();
    EXPECT_EQ(box->round(), nullptr);
    EXPECT_EQ(box->triangles().size(), 12u);
    EXPECT_NEAR(box->report().volume, 0.048, 1e-15);
    EXPECT_TRUE(verdict_of(plane->report()).good);
    EXPECT_TRUE(contains(*plane, {412.3, -77.1, 0}));
    EXPECT_FALSE(contains(*plane, {412.3, -77.1, 1e-12}));
    // Far from its middle, its float32 costs a contact no depth.
    const float deep = 1e-5f;
    const auto contacts = collide(*plane, {}, *box, at({871.3, -913.7, 0.3 - double(deep)}));
    ASSERT_EQ(contacts.size(), 4u);
    for (const Contact& contact : contacts) EXPECT_NEAR(contact.depth, deep, 3e-8f);
}

TEST(Primitives, HeightFieldsAreClosedMeshesOfTheirSamples) {
    Random random(11);
    const HeightGrid grid{7, 5, 0.5, 0.25};
    std::vector<double> heights;
    for (int i = 0; i < 35; ++i) heights.push_back(random.uniform(0.1, 1));
    const ShapePtr field = make_height_field(heights, grid, -0.5);
    EXPECT_TRUE(verdict_of(field->report()).good) << verdict_of(field->report()).text;
    EXPECT_TRUE(field->report().repairs.empty());
    double volume = 0;
    for (std::uint32_t i = 0; i < 6; ++i)
        for (std::uint32_t j = 0; j < 4; ++j) {
            const double a = heights[i * 5 + j], b = heights[(i + 1) * 5 + j], c = heights[(i + 1) * 5 + j + 1],
                         d = heights[i * 5 + j + 1];
            volume += 0.0625 * ((a + b + c) / 3 + (a + c + d) / 3) + 0.125 * 0.5;
        }
    EXPECT_NEAR(field->report().volume, volume, 1e-12);
    for (std::uint32_t i = 0; i < 7; ++i)
        for (std::uint32_t j = 0; j < 5; ++j) {
            const double x = 0.5 * i, y = 0.25 * j, z = heights[i * 5 + j];
            EXPECT_TRUE(contains(*field, {x, y, z}));
            EXPECT_FALSE(contains(*field, {x, y, z + 1e-9}));
        }
}

TEST(Primitives, BadMeasuresAreRefused) {
    const double nan = std::nan("");
    for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity(), 1e9, 1e-7}) {
        EXPECT_THROW(make_ball(bad), InputError);
        EXPECT_THROW(make_capsule(bad, 1), InputError);
        EXPECT_THROW(make_box({1, bad, 1}), InputError);
        EXPECT_THROW(make_plane(bad), InputError);
        EXPECT_THROW(make_plane(1, bad), InputError);
    }
    EXPECT_THROW(make_capsule(1, -1e-9), InputError);
    EXPECT_THROW(make_capsule(1, nan), InputError);
    const std::vector<double> four{1, 1, 1, 1}, with_nan{1, 1, nan, 1};
    EXPECT_THROW(make_height_field(four, {4, 1}, 0), InputError);
    EXPECT_THROW(make_height_field(four, {2, 3}, 0), InputError);
    EXPECT_THROW(make_height_field(four, {2, 2, 0, 1}, 0), InputError);
    EXPECT_THROW(make_height_field(four, {2, 2}, 1), InputError);
    EXPECT_THROW(make_height_field(four, {2, 2}, nan), InputError);
    try {
        make_height_field(with_nan, {2, 2}, 0);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("height 2 "), std::string::npos) << error.what();
    }
}

TEST(RoundQueries, PointsAreAsFarAsTheyAre) {
    Random random(1);
    int inside = 0;
    for (int i = 0; i < 3000; ++i) {
        const ShapePtr shape = round_shapes()[i % 5];
        const Pose pose = anywhere(random, i % 7 == 0 ? 1e4 : 2);
        const double rounding = i % 7 == 0 ? 1e-11 : 1e-14;
        const Vec3 point = pose.translation + (i % 2 == 0 ? 2 : 0.5) * random.in_ball();
        const double metres = to_surface(*shape, pose, point);
        const SignedDistance found = signed_distance(*shape, pose, {&point, 1})[0];
        ASSERT_NEAR(found.distance, metres, 1e-7 + rounding);
        ASSERT_NEAR(to_surface(*shape, pose, found.point), 0, 1e-7);
        ASSERT_NEAR(apart(found.point, point), std::fabs(found.distance), rounding);
        ASSERT_NEAR(length(found.gradient), 1, 1e-14);
        ASSERT_LT(apart(found.point + found.distance * found.gradient, point), rounding);
        ASSERT_EQ(found.triangle, Shape::no_triangle);
        ASSERT_EQ(contains(*shape, pose, point), found.distance <= 0);
        inside += found.distance <= 0 ? 1 : 0;
        const auto closest = closest_point(*shape, pose, point);
        ASSERT_TRUE(closest);
        ASSERT_EQ(closest->distance, std::fabs(found.distance));
        ASSERT_EQ(closest->point, found.point);
        ASSERT_TRUE(closest_point(*shape, pose, point, closest->distance));
        ASSERT_FALSE(closest_point(*shape, pose, point, closest->distance * 0.999));
    }
    EXPECT_GT(inside, 100);
    // In the middle every way out is as short.
    const Vec3 middle{1, 2, 3};
    for (const ShapePtr& shape : round_shapes()) {
        const SignedDistance found = signed_distance(*shape, at(middle), {&middle, 1})[0];
        EXPECT_EQ(found.distance, -shape->round()->radius);
        EXPECT_NEAR(to_surface(*shape, at(middle), found.point), 0, 1e-7);
    }
}

TEST(RoundQueries, RaysMeetTheSurface) {
    Random random(2);
    int hits = 0, from_inside = 0;
    for (int i = 0; i < 3000; ++i) {
        const ShapePtr shape = round_shapes()[i % 5];
        const Pose pose = anywhere(random, 1);
        const Vec3 origin = pose.translation + random.uniform(0, 3) * random.in_ball();
        Vec3 way = i % 3 == 0 ? random.direction() : pose.translation + 0.5 * random.in_ball() - origin;
        if (i % 11 == 0) way = {pose.rotation[2], pose.rotation[5], pose.rotation[8]}; // along the axis
        const auto hit = raycast(*shape, pose, origin, way);
        ASSERT_EQ(raycast_any(*shape, pose, origin, way), hit.has_value());
        const auto off = [&](double metres) {
            const Vec3 point = origin + metres * unit(way);
            return signed_distance(*shape, pose, {&point, 1})[0].distance;
        };
        const double before = hit ? hit->distance : 8;
        for (int k = 0; k < 60; ++k) {
            const double there = off(before * k / 60);
            ASSERT_GT((off(0) < 0 ? -1 : 1) * there, -1e-12) << i;
        }
        if (!hit) continue;
        ++hits;
        from_inside += off(0) < 0 ? 1 : 0;
        ASSERT_NEAR(off(hit->distance), 0, 1e-12);
        ASSERT_LT(apart(hit->point, origin + hit->distance * unit(way)), 1e-12);
        ASSERT_NEAR(length(hit->normal), 1, 1e-14);
        ASSERT_GT((off(0) < 0 ? 1 : -1) * dot(hit->normal, way), -1e-6);
        ASSERT_EQ(hit->triangle, Shape::no_triangle);
        ASSERT_TRUE(raycast(*shape, pose, origin, way, hit->distance));
        ASSERT_FALSE(raycast(*shape, pose, origin, way, hit->distance * 0.999 - 1e-12 > 0 ? hit->distance * 0.999 : 0)
                     && hit->distance > 1e-9);
    }
    EXPECT_GT(hits, 1000);
    EXPECT_GT(from_inside, 100);
    const ShapePtr ball = make_ball(1);
    EXPECT_NEAR(raycast(*ball, {}, {3e6, 1 - 1e-10, 0}, {-2, 0, 0})->distance, 3e6 - std::sqrt(2e-10), 1e-9);
    EXPECT_FALSE(raycast(*ball, {}, {3e6, 1 + 1e-10, 0}, {-2, 0, 0}));
    EXPECT_EQ(raycast(*ball, {}, {1, 0, 0}, {1, 0, 0})->distance, 0); // on the surface
    EXPECT_THROW(raycast(*ball, {}, {}, {}), InputError);
}

void expect_right(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, double metres) {
    const auto found = distance(a, pose_a, b, pose_b);
    ASSERT_TRUE(found);
    ASSERT_NEAR(found->distance, std::max(metres, 0.0), 2e-7);
    ASSERT_EQ(intersects(a, pose_a, b, pose_b), found->distance == 0);
    ASSERT_NEAR(apart(found->point_a, found->point_b), found->distance, 1e-13);
    const auto off = [](const Shape& shape, const Pose& pose, const Vec3& point) {
        return signed_distance(shape, pose, {&point, 1})[0].distance;
    };
    const auto common = common_point(a, pose_a, b, pose_b);
    ASSERT_EQ(common.has_value(), found->distance == 0);
    if (common) {
        for (const auto& [shape, pose] : {std::pair(&a, &pose_a), std::pair(&b, &pose_b)})
            ASSERT_LE(off(*shape, *pose, *common), shape->has_inside() ? 1e-12 : 1e-12 + 1e-9);
        return;
    }
    ASSERT_NEAR(off(a, pose_a, found->point_a), 0, 1e-12);
    ASSERT_NEAR(off(b, pose_b, found->point_b), 0, 1e-12);
    ASSERT_TRUE(distance(a, pose_a, b, pose_b, found->distance));
    ASSERT_FALSE(distance(a, pose_a, b, pose_b, found->distance * 0.999));
    ASSERT_EQ(found->triangle_a == Shape::no_triangle, a.round() != nullptr);
    ASSERT_EQ(found->triangle_b == Shape::no_triangle, b.round() != nullptr);
}

TEST(RoundQueries, DistancesOfRoundBodies) {
    Random random(3);
    int meet = 0;
    for (int i = 0; i < 1500; ++i) {
        const ShapePtr a = round_shapes()[i % 5], b = round_shapes()[random.below(5)];
        const double spread = i % 2 == 0 ? 1.2 : 0.5;
        const Pose pose_a = anywhere(random, spread), pose_b = i % 50 == 0 ? pose_a : anywhere(random, spread);
        const double metres = between_round(*a, pose_a, *b, pose_b);
        expect_right(*a, pose_a, *b, pose_b, metres);
        if (HasFatalFailure()) FAIL() << i;
        meet += metres < 0 ? 1 : 0;
    }
    EXPECT_GT(meet, 300);
    // Side by side, end to end, and far from the origin.
    const ShapePtr rod = make_capsule(0.25, 1), ball = make_ball(0.5);
    EXPECT_NEAR(distance(*rod, {}, *rod, at({0.6, 0.8, 0.7}))->distance, 0.5, 1e-15);
    EXPECT_NEAR(distance(*rod, {}, *rod, at({0, 0, 3}))->distance, 0.5, 1e-15);
    const Vec3 far{1 << 20, -(1 << 21), 1 << 22};
    EXPECT_NEAR(distance(*rod, at(far), *ball, at(far + Vec3{0, 3, 5}))->distance, 4.25, 1e-14);
    EXPECT_NEAR(closest_point(*ball, at(far), far + Vec3{0, 3, 4})->distance, 4.5, 1e-14);
    EXPECT_NEAR(raycast(*ball, at(far), far + Vec3{0, 3, 4}, {0, -3, -4})->distance, 4.5, 1e-14);
    EXPECT_EQ(distance(*ball, {}, *ball, at({0, 3, 4}))->distance, 4);
    EXPECT_TRUE(intersects(*ball, {}, *ball, at({1, 0, 0})));
    EXPECT_FALSE(intersects(*ball, {}, *ball, at({1 + 1e-15, 0, 0})));
}

TEST(RoundQueries, DistancesOfRoundBodiesAndMeshes) {
    Random random(4);
    const std::vector<Mesh> meshes{
        box_mesh({0.7, 0.35, 1.1}), l_prism_mesh(),   frame_mesh(),  bumpy_octahedron_mesh(4),
        tetrahedron_mesh(),         open_box_mesh(2), sheet_mesh(3), box_mesh({2, 1e-5, 2})};
    std::vector<ShapePtr> shapes;
    shapes.reserve(meshes.size());
    for (const Mesh& mesh : meshes) shapes.push_back(Shape::make(mesh));
    int inside = 0, meet = 0, pierce = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::size_t number = std::size_t(i) % meshes.size();
        const Shape& mesh = *shapes[number];
        const ShapePtr round = round_shapes()[random.below(5)];
        const double spread = i % 3 == 0 ? 0.5 : 1.5;
        const Pose pose = anywhere(random, spread), round_pose = anywhere(random, spread);
        const auto triangles = brute::placed(meshes[number], pose);
        double metres = to_mesh(*round, round_pose, triangles);
        const Vec3 end = on_axis(*round, round_pose, 0);
        const bool is_inside = mesh.has_inside() && std::fabs(brute::winding(triangles, end)) > 0.5;
        inside += is_inside && metres > 0 ? 1 : 0;
        meet += metres < 0 ? 1 : 0;
        pierce += metres < -0.999 * round->round()->radius ? 1 : 0;
        if (is_inside) metres = 0;
        expect_right(mesh, pose, *round, round_pose, metres);
        expect_right(*round, round_pose, mesh, pose, metres);
        if (HasFatalFailure()) FAIL() << i;
    }
    EXPECT_GT(inside, 50);
    EXPECT_GT(meet, 500);
    EXPECT_GT(pierce, 50);
    // Through the middle of faces whose edges are far away, deep inside, and around a mesh.
    const Shape &thin = *shapes[7], &box = *shapes[0];
    const ShapePtr needle = make_capsule(1e-3, 0.5);
    EXPECT_EQ(distance(thin, {}, *needle, {{1, 0, 0, 0, 0, 1, 0, -1, 0}, {0.3, 0.1, 0.7}})->distance, 0);
    EXPECT_TRUE(intersects(*make_ball(0.01), {}, box, {}));
    EXPECT_TRUE(intersects(*make_ball(5), {}, box, at({0.1, 0.2, 0.3})));
    EXPECT_FALSE(intersects(*make_ball(0.01), {}, *shapes[5], at({-0.5, -0.5, -0.5})));
    EXPECT_NEAR(distance(*make_ball(0.25), at({0, 0, 2}), box, {})->distance, 0.65, 1e-15);
}

/// Straight, or turning about its own origin, or about something else.
RigidMotion any_motion(Random& random, double spread) {
    const Pose from = anywhere(random, spread);
    const Vec3 turn = random.below(2) == 0 ? Vec3{} : 4 * random.in_ball();
    return {from, spread * random.in_ball(), turn, random.below(2) == 0 ? Vec3{} : random.in_ball()};
}

TEST(RoundQueries, MovingBodiesMeetWhenTheyMeet) {
    Random random(5);
    std::vector<ShapePtr> shapes = round_shapes();
    for (const Mesh& mesh : {box_mesh({0.7, 0.35, 1.1}), frame_mesh(), bumpy_octahedron_mesh(3), sheet_mesh(3)})
        shapes.push_back(Shape::make(mesh));
    int met = 0, on_the_way = 0;
    for (int i = 0; i < 600; ++i) {
        const Shape &a = *shapes[i % 5], &b = *shapes[random.below(9)];
        const RigidMotion motion_a = any_motion(random, 1.8), motion_b = any_motion(random, 1.8);
        const double near = i % 3 == 0 ? 0.1 : 0, tolerance = 1e-6;
        const auto apart_at = [&](double time) {
            return distance(a, pose_at(motion_a, time), b, pose_at(motion_b, time))->distance;
        };
        const bool turned = i % 2 == 0;
        const auto found = turned ? time_of_impact(b, motion_b, a, motion_a, near, tolerance)
                                  : time_of_impact(a, motion_a, b, motion_b, near, tolerance);
        const double until = found ? found->time : 1;
        for (int k = 0; k < 200; ++k)
            if (until > 0) {
                ASSERT_GE(apart_at(until * k / 200), near) << i;
            }
        if (!found) continue;
        ++met;
        ASSERT_LE(apart_at(until), near + tolerance * 1.001) << i;
        ASSERT_LE(found->distance, near + tolerance * 1.001) << i;
        ASSERT_NEAR(apart(found->point_a, found->point_b), found->distance, 1e-12) << i;
        if (until == 0) continue;
        ++on_the_way;
        ASSERT_NEAR(length(found->normal), 1, 1e-12);
        // With a tolerance other parts may be as near.
        const Distance there = *distance(a, pose_at(motion_a, until), b, pose_at(motion_b, until));
        ASSERT_NEAR(there.distance, found->distance, tolerance) << i;
        const Vec3& of_a = turned ? found->point_b : found->point_a;
        const Vec3 point = of_a;
        ASSERT_NEAR(signed_distance(a, pose_at(motion_a, until), {&point, 1})[0].distance, 0, 1e-12) << i;
    }
    EXPECT_GT(met, 120);
    EXPECT_GT(on_the_way, 60);
}

TEST(RoundQueries, ABallFallsAndRolls) {
    const ShapePtr plane = make_plane(50, 1), ball = make_ball(0.25);
    const RigidMotion fall{at({0.3, 0.2, 2.25}), {1, 0, -4}, {1, 2, 3}, {}};
    const auto met = time_of_impact(*ball, fall, *plane, no_motion({}), 0, 1e-9);
    ASSERT_TRUE(met);
    EXPECT_NEAR(met->time, 0.5, 1e-9);
    EXPECT_LE(met->time, 0.5);
    EXPECT_NEAR(met->normal.z, -1, 1e-12);
    EXPECT_NEAR(met->point_a.x, 0.8, 1e-8);
    EXPECT_NEAR(met->point_b.z, 0, 1e-12);
    // A facet would turn down into the ground.
    const double height = 0.25 + 1e-6;
    const RigidMotion roll{at({-20, 0, height}), {40, 0, 0}, {0, 40 / 0.25, 0}, {}};
    EXPECT_FALSE(time_of_impact(*ball, roll, *plane, no_motion({}), 0, 1e-7));
    // Poses on the way, from screw to screw.
    std::vector<Pose> path;
    for (int i = 0; i <= 40; ++i) path.push_back(pose_at(roll, i / 400.0));
    EXPECT_FALSE(time_of_impact(*ball, path, *plane, std::vector<Pose>{{}}, 0, 1e-7));
    const ShapePtr roller = make_capsule(0.25, 1);
    RigidMotion rolling = roll;
    rolling.from.rotation = {1, 0, 0, 0, 0, 1, 0, -1, 0}; // its axis along y
    EXPECT_FALSE(time_of_impact(*roller, rolling, *plane, no_motion({}), 0, 1e-7));
    rolling.from.translation.z = 0.25; // touching at the start is met
    EXPECT_EQ(time_of_impact(*roller, rolling, *plane, no_motion({}), 0, 1e-7)->time, 0);
}

TEST(RoundQueries, ClearanceOnTheWay) {
    const ShapePtr ball = make_ball(0.5), small = make_ball(0.1), box = make_box({1, 1, 1});
    const RigidMotion past{at({-3, 2, 0}), {6, 0, 0}, {0, 0, 5}, {}};
    const auto least = path_clearance(*small, past, *ball, no_motion({}), any_distance, 1e-9);
    ASSERT_TRUE(least);
    EXPECT_NEAR(least->distance, 1.4, 1e-9);
    EXPECT_NEAR(least->time, 0.5, 1e-4);
    EXPECT_NEAR(path_clearance(*box, no_motion({}), *small, past, any_distance, 1e-9)->distance, 0.9, 1e-9);
    EXPECT_FALSE(path_clearance(*small, past, *ball, no_motion({}), 1.3));

    Random random(8);
    const std::vector<ShapePtr> meshes{Shape::make(frame_mesh()), Shape::make(bumpy_octahedron_mesh(3)),
                                       Shape::make(sheet_mesh(3)), make_ball(0.3)};
    int met = 0, clear = 0;
    for (int i = 0; i < 60; ++i) {
        const Shape &a = *round_shapes()[i % 5], &b = *meshes[i % 4];
        const RigidMotion motion_a = any_motion(random, 2), motion_b = any_motion(random, 2);
        const auto found = path_clearance(a, motion_a, b, motion_b, any_distance, 1e-4);
        ASSERT_TRUE(found) << i;
        (found->distance > 0 ? clear : met) += 1;
        const auto apart_at = [&](double time) {
            return distance(a, pose_at(motion_a, time), b, pose_at(motion_b, time))->distance;
        };
        ASSERT_NEAR(apart_at(found->time), found->distance, 1e-6) << i;
        for (int k = 0; k <= 300 && found->distance > 1e-4; ++k)
            ASSERT_GE(apart_at(k / 300.0), found->distance - 1e-4) << i;
    }
    EXPECT_GT(met, 5);
    EXPECT_GT(clear, 10);
}

TEST(RoundQueries, SeparationPartsThem) {
    const auto parted = [](Pose pose_b, const Separation& found) {
        pose_b.translation += std::max(-found.distance, 0.0) * found.normal;
        return pose_b;
    };
    const ShapePtr ball = make_ball(0.5), small = make_ball(0.25), box = make_box({1, 2, 3});
    const Separation balls = separation(*ball, {}, *small, at({0, 0.6, 0}));
    EXPECT_NEAR(balls.distance, -0.15, 3e-6);
    EXPECT_NEAR(balls.normal.y, 1, 1e-6);
    EXPECT_NEAR(separation(*box, {}, *small, at({0.9, 0.3, 0.2})).distance, -0.35, 3e-6);
    EXPECT_NEAR(separation(*ball, {}, *small, at({0, 3, 4})).distance, 4.25, 1e-15);
    // However near they are, the normal is that of the surfaces.
    const Vec3 way{0.36, 0.48, 0.8};
    EXPECT_LT(apart(separation(*ball, {}, *small, at((0.75 + 1e-15) * way)).normal, way), 1e-14);
    for (const double gap : {2e-15, 1e-12}) {
        const Pose above = at({0.3, -0.2, 3.25 + gap});
        EXPECT_LT(apart(separation(*box, {}, *small, above).normal, {0, 0, 1}), 1e-14);
        EXPECT_LT(apart(time_of_impact(*small, above, above, *box, {}, {})->normal, {0, 0, -1}), 1e-14);
    }

    Random random(6);
    std::vector<ShapePtr> shapes = round_shapes();
    for (const Mesh& mesh : {box_mesh({0.7, 0.35, 1.1}), l_prism_mesh(), frame_mesh(), bumpy_octahedron_mesh(2),
                             open_box_mesh(1), sheet_mesh(2)})
        shapes.push_back(Shape::make(mesh));
    int overlapping = 0;
    for (int i = 0; i < 300; ++i) {
        const Shape &a = *shapes[random.below(11)], &b = *shapes[i % 5];
        const Pose pose_a = anywhere(random, 0.8), pose_b = anywhere(random, 0.8);
        const Separation found = separation(a, pose_a, b, pose_b);
        const double outside = distance(a, pose_a, b, pose_b)->distance;
        ASSERT_NEAR(length(found.normal), 1, 1e-12);
        if (outside > 0) {
            ASSERT_EQ(found.distance, outside);
        }
        if (outside > 0) continue;
        ++overlapping;
        ASSERT_LT(found.distance, 0);
        const auto after = distance(a, pose_a, b, parted(pose_b, found));
        ASSERT_GT(after->distance, 0) << i;
        ASSERT_LT(after->distance, 1e-4) << i;
        // No way at random is shorter: to a hundredth for convex bodies, to a tenth for the others.
        const bool convex = a.round() != nullptr || &a == shapes[5].get();
        for (int k = 0; k < 60; ++k) {
            Pose pose = pose_b;
            pose.translation += (convex ? 0.99 : 0.9) * -found.distance * random.direction();
            if (-found.distance > 1e-3) {
                ASSERT_TRUE(intersects(a, pose_a, b, pose)) << i;
            }
        }
        if (a.round() == nullptr) continue;
        const double deep = -between_round(a, pose_a, b, pose_b);
        if (deep < a.round()->radius + b.round()->radius - 1e-6) {
            ASSERT_NEAR(-found.distance, deep, 0.005 * deep + 1e-5) << i;
        }
    }
    EXPECT_GT(overlapping, 120);
}

TEST(RoundQueries, ScenesAnswerWithThem) {
    Random random(7);
    Scene scene;
    std::vector<std::pair<ShapePtr, Pose>> bodies;
    const std::vector<ShapePtr> shapes{Shape::make(box_mesh({0.35, 0.1, 0.2})), Shape::make(bumpy_octahedron_mesh(3)),
                                       Shape::make(sheet_mesh(3))};
    for (std::size_t i = 0; i < 60; ++i) {
        bodies.emplace_back(shapes[i % 3], anywhere(random, 4));
        scene.add(bodies.back().first, bodies.back().second);
    }
    int met = 0, hit = 0;
    for (int i = 0; i < 100; ++i) {
        const ShapePtr round = round_shapes()[i % 5];
        const Pose pose = anywhere(random, 4);
        std::vector<std::uint32_t> wanted, found;
        for (std::uint32_t k = 0; k < bodies.size(); ++k)
            if (intersects(*bodies[k].first, bodies[k].second, *round, pose)) wanted.push_back(k);
        for (const BodyId body : scene.overlaps(*round, pose)) found.push_back(body.slot);
        ASSERT_EQ(found, wanted);
        ASSERT_EQ(scene.overlaps_any(*round, pose), !wanted.empty());
        met += wanted.empty() ? 0 : 1;
        const RigidMotion motion{pose, 6 * random.in_ball(), 3 * random.in_ball(), random.in_ball()};
        std::size_t count = 0;
        double first = 2;
        for (const auto& [shape, place] : bodies)
            if (const auto impact = time_of_impact(*round, motion, *shape, no_motion(place))) {
                ++count;
                first = std::min(first, impact->time);
            }
        const auto nearest = scene.sweep(*round, motion);
        ASSERT_EQ(nearest.has_value(), count > 0);
        ASSERT_EQ(scene.sweep_all(*round, motion).size(), count);
        if (nearest) {
            ASSERT_NEAR(nearest->time, first, 1e-6);
        }
        hit += count > 0 ? 1 : 0;
    }
    EXPECT_GT(met, 20);
    EXPECT_GT(hit, 40);
}

TEST(RoundQueries, WhatTakesMeshesAloneRefusesThem) {
    const ShapePtr ball = make_ball(0.5), box = make_box({1, 1, 1});
    EXPECT_THROW(contact_patches(*box, {}, *ball, {}), InputError);
    EXPECT_THROW(overlap_volume(*box, {}, *ball, {}), InputError);
}

TEST(Primitives, LongThinCapsulesAreMade) {
    for (const auto& [radius, half] : {std::pair{1e-6, 1e8}, {1e-6, 3e7}, {1e-5, 1e8}, {5e-6, 1e8}}) {
        const auto capsule = make_capsule(radius, half);
        EXPECT_EQ(capsule->round()->radius, radius);
        EXPECT_TRUE(contains(*capsule, {0, 0, half}));
        EXPECT_FALSE(contains(*capsule, {3 * radius, 0, 0}));
    }
}

// A face so thin that it has no normal to a float's precision is pierced all the same, whatever its first corner.
TEST(RoundQueries, ACapsulePiercesANeedle) {
    constexpr double wide = 9e-4;
    for (std::uint32_t first = 0; first < 3; ++first) {
        Mesh sheet;
        sheet.vertices = {{0, 0, 0}, {1000, 0, 0}, {1000, wide, 0}, {0, wide, 0}};
        for (const std::array<std::uint32_t, 3>& t : {std::array{0u, 1u, 2u}, std::array{0u, 2u, 3u}})
            sheet.triangles.push_back({t[first], t[(first + 1) % 3], t[(first + 2) % 3]});
        const auto needle = Shape::make(sheet), capsule = make_capsule(9e-6, 1);
        for (const double x : {100.0, 333.3, 750.0})
            for (const double y : {0.2 * wide, 0.35 * wide, 0.8 * wide})
                EXPECT_TRUE(intersects(*needle, {}, *capsule, {.translation = {x, y, 0.3}})) << first << ' ' << x;
    }
}

} // namespace
} // namespace raycontact
