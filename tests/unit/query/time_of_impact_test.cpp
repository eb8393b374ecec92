// SPDX-License-Identifier: Apache-2.0
// Times of impact against dense samples by distance() and intersects(), against angles and ways that are known, and of
// what passes without being met.
#include <raycontact/error.h>
#include <raycontact/scene.h>

#include "reference/meshes.h"
#include "reference/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;
using ShapePtr = std::shared_ptr<const Shape>;

constexpr double pi = std::numbers::pi;

Vec3 sum(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double apart(const Vec3& a, const Vec3& b) {
    return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}
Pose at(const Vec3& place) {
    return {.translation = place};
}
Pose turned(const Vec3& axis, double angle, const Vec3& place = {}) {
    Pose pose = pose_from_quaternion({}, std::cos(angle / 2), std::sin(angle / 2) * axis.x,
                                     std::sin(angle / 2) * axis.y, std::sin(angle / 2) * axis.z);
    pose.translation = place;
    return pose;
}
/// About an axis through a point, without a shift.
RigidMotion turning(const Pose& from, const Vec3& axis, double angle, const Vec3& point = {}) {
    return {from, {}, {angle * axis.x, angle * axis.y, angle * axis.z}, sum(point, -1, from.translation)};
}
RigidMotion moving(const Pose& from, const Vec3& by) {
    return {from, by, {}, {}};
}

std::vector<ShapePtr> small_shapes() {
    std::vector<ShapePtr> shapes;
    for (const Mesh& mesh : {box_mesh({0.7, 0.35, 1.1}), box_mesh({1.5, 0.02, 0.1}), tetrahedron_mesh(), cone_mesh(),
                             l_prism_mesh(), frame_mesh(), bumpy_octahedron_mesh(2), open_box_mesh(1), sheet_mesh(2)})
        shapes.push_back(Shape::make(mesh));
    return shapes;
}

/// Straight ways, turns about near and far axes, screws, free flight, many rounds, and what stays.
RigidMotion any_motion(Random& random, double spread) {
    Pose from = random.rotation(), to = random.rotation();
    from.translation = sum({}, spread, random.in_ball());
    to.translation = sum({}, spread, random.in_ball());
    switch (random.below(7)) {
    case 0:
        return moving(from, sum(to.translation, -1, from.translation));
    case 1:
        return turning(from, random.direction(), random.uniform(0, 3), sum({}, 3, random.in_ball()));
    case 2:
        return screw_motion(from, to);
    case 3:
        return straight_motion(from, to, random.in_ball());
    case 4:
        return turning(from, random.direction(), random.uniform(3, 40), sum(from.translation, 1, random.in_ball()));
    case 5: {
        RigidMotion motion = straight_motion(from, to);
        motion.angular_velocity = sum({}, 15, random.in_ball());
        return motion;
    }
    default:
        return no_motion(from);
    }
}

bool are_near(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b, double time,
              double reach) {
    const Pose pose_a = pose_at(motion_a, time), pose_b = pose_at(motion_b, time);
    return reach == 0 ? intersects(a, pose_a, b, pose_b) : distance(a, pose_a, b, pose_b, reach).has_value();
}

TEST(TimeOfImpact, OfRandomMotionsIsNeverLateAndNotEarly) {
    const std::vector<ShapePtr> shapes = small_shapes();
    Random random(1);
    const int pairs = 10000, samples = 40;
    std::array<int, 3> told{}; // at the start, on the way, never
    for (int i = 0; i < pairs; ++i) {
        const Shape &a = *shapes[random.below(std::uint32_t(shapes.size()))],
                    &b = *shapes[random.below(std::uint32_t(shapes.size()))];
        const double spread = random.uniform(0.5, 7), reach = i % 3 == 0 ? random.uniform(0, 0.5) : 0;
        const RigidMotion motion_a = any_motion(random, spread);
        RigidMotion motion_b = any_motion(random, spread);
        if (i % 5 == 0) { // both ride on one wheel
            motion_b = {motion_b.from, motion_a.velocity, motion_a.angular_velocity,
                        sum(sum(motion_a.centre, 1, motion_a.from.translation), -1, motion_b.from.translation)};
            if (i % 10 == 0) motion_b.velocity = sum(motion_b.velocity, 1, random.in_ball());
        }
        const double tolerance = i % 2 == 0 ? 0 : 1e-4, allowed = std::max(tolerance, 1e-6);
        const auto impact = time_of_impact(a, motion_a, b, motion_b, reach, tolerance);
        const double end = impact ? impact->time : 1;
        ASSERT_TRUE(end >= 0 && end <= 1) << i;
        told[!impact ? 2 : end > 0 ? 1 : 0]++;
        for (int k = 0; k < samples; ++k) {
            const double time = end * (k / double(samples - 1)) * (impact ? 1 - 1e-9 : 1);
            if (end == 0) break;
            ASSERT_FALSE(are_near(a, motion_a, b, motion_b, time, reach)) << i << ": " << time << " before " << end;
        }
        if (!impact) continue;
        const Pose pose_a = pose_at(motion_a, end), pose_b = pose_at(motion_b, end);
        ASSERT_TRUE(distance(a, pose_a, b, pose_b, reach + allowed)) << i;
        ASSERT_NEAR(impact->distance, apart(impact->point_a, impact->point_b), 1e-9) << i;
        ASSERT_LE(impact->distance, reach + allowed) << i;
        if (impact->distance == 0) continue;
        ASSERT_NEAR(apart(sum(impact->point_a, impact->distance, impact->normal), impact->point_b), 0, 1e-9) << i;
        for (const auto& [shape, pose, point, triangle] :
             {std::tuple(&a, &pose_a, &impact->point_a, impact->triangle_a),
              std::tuple(&b, &pose_b, &impact->point_b, impact->triangle_b)}) {
            const auto closest = closest_point(*shape, *pose, *point);
            ASSERT_LE(closest->distance, 1e-9) << i;
            ASSERT_LT(triangle, shape->report().file_triangles) << i;
        }
    }
    for (const int count : told) EXPECT_GT(count, pairs / 20);
}

TEST(PathClearance, OfRandomMotionsIsTheLeast) {
    const std::vector<ShapePtr> shapes = small_shapes();
    Random random(7);
    int apart_count = 0;
    for (int i = 0; i < 400; ++i) {
        const Shape &a = *shapes[random.below(std::uint32_t(shapes.size()))],
                    &b = *shapes[random.below(std::uint32_t(shapes.size()))];
        const RigidMotion motion_a = any_motion(random, 6), motion_b = any_motion(random, 6);
        const double tolerance = i % 2 == 0 ? 1e-5 : 0, allowed = i % 2 == 0 ? 1e-5 : 1e-3;
        const auto found = path_clearance(a, motion_a, b, motion_b, any_distance, tolerance);
        ASSERT_TRUE(found) << i;
        const auto distance_at = [&](double time, double max) {
            return distance(a, pose_at(motion_a, time), b, pose_at(motion_b, time), max);
        };
        ASSERT_TRUE(distance_at(found->time, found->distance + 1e-9)) << i;
        ASSERT_NEAR(apart(found->point_a, found->point_b), found->distance, 1e-9) << i;
        if (const auto met = time_of_impact(a, motion_a, b, motion_b)) {
            ASSERT_EQ(found->time, met->time) << i;
            ASSERT_LE(found->distance, 1e-6) << i;
            continue;
        }
        ++apart_count;
        ASSERT_GT(found->distance, 0) << i;
        for (int k = 0; k <= 200; ++k)
            ASSERT_FALSE(distance_at(k / 200.0, std::max(found->distance - allowed, 0.0))) << i << ": " << k;
        ASSERT_FALSE(path_clearance(a, motion_a, b, motion_b, std::max(found->distance - 2 * allowed, 0.0), tolerance));
        const auto within = path_clearance(a, motion_a, b, motion_b, found->distance + 2 * allowed, tolerance);
        ASSERT_TRUE(within) << i;
        ASSERT_NEAR(within->distance, found->distance, allowed) << i;
    }
    EXPECT_GT(apart_count, 50);
}

// Past a corner, 0.3 m away at the nearest, between two poses of a path.
TEST(PathClearance, OfAPathIsBetweenItsPoses) {
    const ShapePtr part = Shape::make(box_mesh({0.1, 0.1, 0.1})), post = Shape::make(box_mesh({0.5, 0.5, 2}));
    const std::vector<Pose> path{at({-3, -0.9, 0}), at({2, -0.9, 0}), at({2, 3, 0})}, stays{Pose{}};
    const auto found = path_clearance(*part, path, *post, stays, any_distance, 1e-6);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, 0.3, 1e-6);
    EXPECT_GT(found->time, 2.4 / 5 - 1e-3);
    EXPECT_LT(found->time, 3.6 / 5 + 1e-3);
    EXPECT_FALSE(path_clearance(*part, path, *post, stays, 0.29));
    EXPECT_THROW(path_clearance(*part, path, *post, stays, -1), InputError);
}

TEST(TimeOfImpact, OfAFallIsThatOfTheWay) {
    const ShapePtr floor = Shape::make(box_mesh({5, 5, 1})), part = Shape::make(l_prism_mesh());
    const double low = part->box_min().z;
    const auto impact = time_of_impact(*part, at({0, 0, 4}), at({0.5, 0, -4}), *floor, {}, {});
    ASSERT_TRUE(impact);
    EXPECT_NEAR(impact->time, (4 + low - 1) / 8, 1e-7);
    EXPECT_LE(impact->time, (4 + low - 1) / 8);
    EXPECT_NEAR(impact->normal.z, -1, 1e-9);
    EXPECT_NEAR(impact->point_b.z, 1, 1e-12);
    // 0.25 m above it.
    const auto above = time_of_impact(*part, at({0, 0, 4}), at({0.5, 0, -4}), *floor, {}, {}, 0.25);
    ASSERT_TRUE(above);
    EXPECT_NEAR(above->time, (4 + low - 1 - 0.25) / 8, 1e-7);
    EXPECT_NEAR(above->distance, 0.25, 1e-6);
    // Whoever moves.
    const auto rising = time_of_impact(*part, {}, {}, *floor, at({0, 0, -4}), at({-0.5, 0, 4}));
    ASSERT_TRUE(rising);
    EXPECT_NEAR(rising->time, impact->time, 1e-7);
}

// A blade of 1.5 m at 100 rad/s, a bar at 1 m from the axis: its near side is met at a known angle.
TEST(TimeOfImpact, OfABladeIsThatOfItsAngle) {
    const ShapePtr blade = Shape::make(box_mesh({1.5, 0.02, 0.1})), bar = Shape::make(box_mesh({0.05, 0.05, 2}));
    const double angle = 1.2, reach = std::hypot(0.95, 0.05);
    const Pose place = turned({0, 0, 1}, angle, {std::cos(angle), std::sin(angle), 0});
    const double met = angle - std::asin(0.05 / reach) - std::asin(0.02 / reach);
    for (const double seconds : {1 / 60.0, 1.0, 10.0}) {
        const double turn = 100 * seconds;
        const auto impact = time_of_impact(*blade, turning({}, {0, 0, 1}, turn), *bar, no_motion(place));
        ASSERT_TRUE(impact) << seconds;
        EXPECT_NEAR(impact->time * turn, met, 1e-6) << seconds;
        EXPECT_LE(impact->time * turn, met + 1e-12) << seconds;
    }
    // The other way round: the blade's other half comes first.
    const auto back = time_of_impact(*blade, turning({}, {0, 0, -1}, 100), *bar, no_motion(place));
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->time * 100, pi - (2 * angle - met), 1e-6);
    // Both ride on one wheel: nothing is met in 16 rounds.
    EXPECT_FALSE(time_of_impact(*blade, turning({}, {0, 0, 1}, 100), *bar, turning(place, {0, 0, 1}, 100)));
}

/// A prism with n corners of a circle about z, its first at angle 0; hollow: the same turned inside out, in a cube.
Mesh prism_mesh(std::uint32_t n, double radius, double half) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < n; ++i)
        for (const double z : {-half, half})
            mesh.vertices.push_back({radius * std::cos(2 * pi * i / n), radius * std::sin(2 * pi * i / n), z});
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
        if (i == 0 || i + 1 == n) continue;
        mesh.triangles.push_back({0, b, a});
        mesh.triangles.push_back({1, a + 1, b + 1});
    }
    return mesh;
}

/// A tube with n corners.
Mesh tube_mesh(std::uint32_t n, double inner, double outer, double half) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < n; ++i)
        for (const double radius : {inner, outer})
            for (const double z : {-half, half})
                mesh.vertices.push_back({radius * std::cos(2 * pi * i / n), radius * std::sin(2 * pi * i / n), z});
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = 4 * i, b = 4 * ((i + 1) % n);
        const auto quad = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
            mesh.triangles.push_back({p, q, r});
            mesh.triangles.push_back({p, r, s});
        };
        quad(a + 1, b + 1, b, a);         // inner, seen from the axis
        quad(a + 2, b + 2, b + 3, a + 3); // outer
        quad(a, b, b + 2, a + 2);         // below
        quad(a + 3, b + 3, b + 1, a + 1); // above
    }
    return mesh;
}

TEST(TimeOfImpact, PartsThatPassAtAMicrometreDoNotMeet) {
    constexpr double gap = 1e-6;
    // Over a floor of many triangles.
    const ShapePtr floor = Shape::make(grid_box_mesh(16)), slider = Shape::make(box_mesh({0.1, 0.2, 0.1}));
    const Pose from = at({-0.5, 0.45, 1.1 + gap}), to = at({1.5, 0.55, 1.1 + gap});
    EXPECT_FALSE(time_of_impact(*slider, from, to, *floor, {}, {}));
    EXPECT_TRUE(time_of_impact(*slider, from, at({1.5, 0.55, 1.1 - gap}), *floor, {}, {}));
    const auto near = time_of_impact(*slider, from, to, *floor, {}, {}, 2 * gap);
    ASSERT_TRUE(near);
    EXPECT_NEAR(near->time, 0.2, 1e-6);

    // A shaft in a bore: turned, pushed and screwed. A bore's facets are nearest to its axis in their middles.
    const ShapePtr shaft = Shape::make(prism_mesh(48, 0.05, 0.3));
    const ShapePtr bore = Shape::make(tube_mesh(48, (0.05 + gap) / std::cos(pi / 48), 0.1, 0.1));
    EXPECT_FALSE(time_of_impact(*shaft, turning({}, {0, 0, 1}, 13), *bore, no_motion({})));
    EXPECT_FALSE(time_of_impact(*shaft, at({0, 0, -0.1}), at({0, 0, 0.15}), *bore, {}, {}));
    EXPECT_FALSE(time_of_impact(*bore, {{}, {0, 0, 0.1}, {0, 0, -7}, {}}, *shaft, turning({}, {0, 0, 1}, 3)));
    // Off its axis by more than the gap it is met where a corner comes to the middle of a facet.
    const auto met = time_of_impact(*shaft, turning({}, {0, 0, 1}, 13), *bore, no_motion(at({2 * gap, 0, 0})));
    ASSERT_TRUE(met);
    EXPECT_LE(met->time * 13, pi / 48);

    // A wheel of 24 corners that rolls over a floor.
    const ShapePtr wheel = Shape::make(prism_mesh(24, 0.2, 0.05));
    const Pose upright = turned({1, 0, 0}, pi / 2, {-0.5, 0.5, 1.2 + gap});
    EXPECT_FALSE(time_of_impact(*wheel, {upright, {2, 0, 0}, {0, 10, 0}, {}}, *floor, no_motion({})));
    EXPECT_TRUE(time_of_impact(*wheel, {upright, {2, 0, -2 * gap}, {0, 10, 0}, {}}, *floor, no_motion({})));
}

// The way between points that nearly touch is rounded, and a large mesh's corners are far from it.
TEST(TimeOfImpact, OfSmallPartsAndLargeOnesIsNotEarlyEither) {
    Random random(9);
    const auto scaled = [](Mesh mesh, double by) {
        for (Vec3& v : mesh.vertices) v = {by * v.x, by * v.y, by * v.z};
        return Shape::make(mesh);
    };
    int met = 0;
    for (int i = 0; i < 1500; ++i) {
        const ShapePtr large = scaled(i % 2 == 0 ? l_prism_mesh() : box_mesh({1, 0.8, 0.6}), random.uniform(5, 10));
        const ShapePtr small =
            scaled(i % 3 == 0 ? l_prism_mesh() : box_mesh({1, 0.7, 1.2}), random.uniform(0.005, 0.015));
        Pose from = random.rotation(), to = random.rotation();
        from.translation = sum({}, 25, random.direction());
        to.translation = sum({}, 5, random.in_ball());
        const RigidMotion motion = screw_motion(from, to), stays = no_motion(random.rotation());
        const auto impact = time_of_impact(*small, motion, *large, stays);
        if (!impact) continue;
        ++met;
        const double tolerance = 1e-7 * apart(small->box_min(), small->box_max());
        ASSERT_TRUE(distance(*small, pose_at(motion, impact->time), *large, stays.from, 1.01 * tolerance)) << i;
    }
    EXPECT_GT(met, 500);
    // Sliding and turning on a floor that is a thousand times larger, ten tolerances above it.
    for (const double size : {1e-1, 1e-2, 1e-3}) {
        const ShapePtr floor = Shape::make(box_mesh({10, 10, 1})), part = Shape::make(box_mesh({size, size, size}));
        const double gap = 1e-6 * apart(part->box_min(), part->box_max());
        for (int i = 0; i < 10; ++i) {
            const Pose frame = random.rotation();
            const auto to_world = [&](const Vec3& v) { return transform_point(frame, v); };
            RigidMotion motion{frame, to_world({18, 0, 0}), to_world({0, 0, 3}), {}};
            motion.from.translation = to_world({-9, 0.1, 1 + size + gap});
            EXPECT_FALSE(time_of_impact(*part, motion, *floor, no_motion(frame))) << size;
        }
    }
}

// Faces that turn on each other bend no path across them: discs, hinges, tables.
TEST(TimeOfImpact, FacesOfManyTrianglesTurnOnEachOther) {
    const ShapePtr plate = Shape::make(grid_box_mesh(16));
    Random random(2);
    const Pose frame = random.rotation();
    const auto to_world = [&](const Vec3& v) { return transform_point(frame, v); };
    Pose above = frame;
    above.translation = to_world({0, 0, 1 + 1e-6});
    const Vec3 middle = to_world({0.5, 0.5, 0});
    for (const double other : {0.0, 19.0, -3.0}) {
        const RigidMotion first{frame, {}, to_world({0, 0, other}), middle};
        EXPECT_FALSE(time_of_impact(*plate, first, *plate, {above, {}, to_world({0, 0, 20}), middle})) << other;
        EXPECT_TRUE(
            time_of_impact(*plate, first, *plate, {above, to_world({0, 0, -2e-6}), to_world({0, 0, 20}), middle}))
            << other;
    }
}

TEST(TimeOfImpact, AlongAPathGoesFromPoseToPose) {
    const ShapePtr part = Shape::make(box_mesh({0.1, 0.1, 0.1})), wall = Shape::make(box_mesh({0.1, 2, 2}));
    // Up, aside, and through the wall in the third piece.
    const std::vector<Pose> path{at({-2, 0, 0}), at({-2, 0, 1}), turned({0, 0, 1}, 0, {-2, 1, 1}), at({0, 1, 1})};
    const std::vector<Pose> stays{Pose{}};
    const auto impact = time_of_impact(*part, path, *wall, stays);
    ASSERT_TRUE(impact);
    EXPECT_NEAR(impact->time, 2 + 1.8 / 2, 1e-7);
    const auto other = time_of_impact(*wall, stays, *part, path);
    ASSERT_TRUE(other);
    EXPECT_NEAR(other->time, impact->time, 1e-7);
    EXPECT_FALSE(time_of_impact(*part, std::span(path).first(3), *wall, stays));
    EXPECT_FALSE(time_of_impact(*part, std::span(path).first(1), *wall, stays));
    const auto start = time_of_impact(*part, std::vector{Pose{}}, *wall, stays);
    ASSERT_TRUE(start);
    EXPECT_EQ(start->time, 0);
    EXPECT_EQ(start->distance, 0);
    EXPECT_EQ(start->normal, Vec3{});
}

TEST(TimeOfImpact, AtTheStartIsDecidedExactly) {
    const ShapePtr box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    // Touching counts, inside counts, also of what moves away.
    EXPECT_EQ(time_of_impact(*box, at({1, 0, 0}), at({2, 0, 0}), *box, {}, {})->time, 0);
    const ShapePtr large = Shape::make(box_mesh({5, 5, 5}));
    EXPECT_EQ(time_of_impact(*box, {}, at({1, 0, 0}), *large, {}, {})->time, 0);
    EXPECT_FALSE(time_of_impact(*box, at({1.001, 0, 0}), at({2, 0, 0}), *box, {}, {}));
    // Out of reach of any box.
    EXPECT_FALSE(time_of_impact(*box, at({1e12, 0, 0}), at({1e12, 1, 0}), *box, {}, {}));
    EXPECT_TRUE(time_of_impact(*box, at({1e9, 0, 0}), at({-1e9, 0, 0}), *box, {}, {}));
}

TEST(TimeOfImpact, ScrewsEndWhereTheyShould) {
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
        Pose from = random.rotation(), to = random.rotation();
        from.translation = random.in_ball();
        to.translation = sum({}, 10, random.in_ball());
        if (i % 4 == 1) to.rotation = from.rotation;
        if (i % 4 == 2) { // next to nothing
            const Pose little = turned(random.direction(), std::pow(10.0, random.uniform(-16, -2)));
            for (std::size_t k = 0; k < 9; ++k) {
                to.rotation[k] = 0;
                for (std::size_t j = 0; j < 3; ++j)
                    to.rotation[k] += little.rotation[3 * (k / 3) + j] * from.rotation[3 * j + k % 3];
            }
        }
        if (i % 4 == 3) { // half a turn
            const Vec3 axis = random.direction();
            const Pose half = turned(axis, pi);
            from.rotation = Pose{}.rotation;
            to.rotation = half.rotation;
        }
        const Vec3 point = random.in_ball();
        for (const RigidMotion& motion : {screw_motion(from, to), straight_motion(from, to, point)}) {
            const Pose start = pose_at(motion, 0), end = pose_at(motion, 1);
            EXPECT_LE(apart(start.translation, from.translation), 1e-12);
            EXPECT_LE(apart(end.translation, to.translation), 1e-12) << i;
            for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(end.rotation[k], to.rotation[k], 1e-13) << i;
        }
        // A screw goes the same way for any point of the body: its middle lies on the screw of the middle.
        const Pose middle = pose_at(screw_motion(from, to), 0.5);
        const Pose again = pose_at(screw_motion(from, middle), 1), rest = pose_at(screw_motion(middle, to), 1);
        EXPECT_LE(apart(again.translation, middle.translation), 1e-12);
        EXPECT_LE(apart(rest.translation, to.translation), 1e-12);
        // The point moves straight.
        const Vec3 begin = transform_point(from, point), finish = transform_point(to, point);
        const Vec3 half_way = transform_point(pose_at(straight_motion(from, to, point), 0.5), point);
        EXPECT_LE(apart(half_way, sum(begin, 0.5, sum(finish, -1, begin))), 1e-12);
    }
}

// As one body after the other says.
TEST(Sweep, MeetsWhatIsInTheWay) {
    const std::vector<ShapePtr> shapes = small_shapes();
    Random random(5);
    Scene scene;
    std::vector<BodyId> bodies;
    for (int i = 0; i < 60; ++i) {
        Pose pose = random.rotation();
        pose.translation = sum({}, 8, random.in_ball());
        bodies.push_back(scene.add(shapes[random.below(std::uint32_t(shapes.size()))], pose));
    }
    int met = 0;
    for (int i = 0; i < 400; ++i) {
        const Shape& shape = *shapes[random.below(std::uint32_t(shapes.size()))];
        const RigidMotion motion = any_motion(random, 12);
        const double reach = i % 3 == 0 ? random.uniform(0, 0.3) : 0;
        const Scene::Wanted some = [&](BodyId body) { return body.slot % 2 == 0 || i % 2 == 0; };
        std::vector<std::pair<double, BodyId>> expected;
        for (const BodyId body : bodies)
            if (const auto impact =
                    time_of_impact(shape, motion, scene.shape(body), no_motion(scene.pose(body)), reach);
                impact && some(body))
                expected.emplace_back(impact->time, body);
        std::ranges::sort(expected);
        const auto first = scene.sweep(shape, motion, reach, some);
        const auto all = scene.sweep_all(shape, motion, reach, some);
        ASSERT_EQ(first.has_value(), !expected.empty()) << i;
        ASSERT_EQ(all.size(), expected.size()) << i;
        for (std::size_t k = 0; k < all.size(); ++k) {
            // Searches that begin and end elsewhere advance by other ways to the same place.
            ASSERT_NEAR(all[k].time, expected[k].first, 1e-5) << i;
            ASSERT_TRUE(k == 0 || all[k - 1].time <= all[k].time) << i;
            const auto same = std::ranges::find(expected, all[k].body, &std::pair<double, BodyId>::second);
            ASSERT_TRUE(same != expected.end()) << i;
            ASSERT_NEAR(all[k].time, same->first, 1e-5) << i;
        }
        if (!first) continue;
        ++met;
        ASSERT_NEAR(first->time, expected[0].first, 1e-5) << i;
        if (first->time == 0) {
            ASSERT_EQ(first->body, expected[0].second) << i;
        }
    }
    EXPECT_GT(met, 100);
    EXPECT_LT(met, 390);
}

TEST(Sweep, OfManyRoundsAndFarPlaces) {
    const ShapePtr blade = Shape::make(box_mesh({1.5, 0.02, 0.1})), box = Shape::make(box_mesh({0.1, 0.1, 0.1}));
    Scene scene;
    const BodyId near = scene.add(box, at({0, 1.2, 0})), far = scene.add(box, at({1e9, 1.2, 0}));
    EXPECT_EQ(scene.sweep(*blade, turning({}, {0, 0, 1}, 1000))->body, near);
    EXPECT_EQ(scene.sweep(*blade, turning(at({1e9, 0, 0}), {0, 0, 1}, 1000, {1e9, 0, 0}))->body, far);
    EXPECT_FALSE(scene.sweep(*blade, turning(at({5, 0, 0}), {0, 0, 1}, 1000, {5, 0, 0})));
    EXPECT_FALSE(Scene{}.sweep(*blade, turning({}, {0, 0, 1}, 1)));
    EXPECT_THROW(scene.sweep(*blade, no_motion({}), -1), InputError);
}

TEST(TimeOfImpact, RefusesWhatIsNotSound) {
    const ShapePtr box = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Pose skewed;
    skewed.rotation[1] = 0.1;
    EXPECT_THROW(time_of_impact(*box, skewed, {}, *box, {}, {}), InputError);
    EXPECT_THROW(time_of_impact(*box, {}, at({nan, 0, 0}), *box, {}, {}), InputError);
    EXPECT_THROW(time_of_impact(*box, at({3, 0, 0}), {}, *box, {}, {}, -1), InputError);
    EXPECT_THROW(time_of_impact(*box, at({3, 0, 0}), {}, *box, {}, {}, 0, nan), InputError);
    EXPECT_THROW(time_of_impact(*box, moving({}, {0, nan, 0}), *box, no_motion({})), InputError);
    EXPECT_THROW(time_of_impact(*box, turning({}, {0, 0, 1}, 1e7), *box, no_motion(at({3, 0, 0}))), InputError);
    EXPECT_THROW(no_motion(skewed), InputError);
    const std::vector<Pose> two(2), three(3), none;
    EXPECT_THROW(time_of_impact(*box, two, *box, three), InputError);
    EXPECT_THROW(time_of_impact(*box, two, *box, none), InputError);
}

} // namespace
} // namespace raycontact
