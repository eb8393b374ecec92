// SPDX-License-Identifier: Apache-2.0
// The volume of overlap: boxes and a sphere's cap by hand, random solids against CGAL.
#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "exact/volume_cgal.h"

#include <raycontact/clash.h>
#include <raycontact/collide.h>
#include <scenes/models/procedural.h>
#include <scenes/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::exact {
namespace {

/// Outward, its middle at the origin.
std::shared_ptr<const Shape> box(double x, double y, double z) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({i & 1 ? x / 2 : -x / 2, i & 2 ? y / 2 : -y / 2, i & 4 ? z / 2 : -z / 2});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return Shape::make(mesh);
}

Pose random_pose(scenes::Random& random, double reach) {
    const auto [w, x, y, z] = random.rotation();
    return pose_from_quaternion({reach * random.symmetric(), reach * random.symmetric(), reach * random.symmetric()}, w,
                                x, y, z);
}

/// The same place in a frame that is turned and shifted.
Pose seen_from(const Pose& frame, const Pose& pose) {
    return relative_pose(frame, pose);
}

TEST(OverlapVolume, OfBoxesIsThatOfTheirSides) {
    const auto a = box(2, 2, 2), b = box(1, 2, 3);
    // By a corner, through a side, whole, flush, touching, apart.
    EXPECT_NEAR(overlap_volume(*a, {}, *b, {.translation = {1, 1.5, 2}}), 0.5 * 0.5 * 0.5, 1e-14);
    EXPECT_NEAR(overlap_volume(*a, {}, *b, {}), 1 * 2 * 2, 1e-14);
    EXPECT_NEAR(overlap_volume(*a, {}, *box(0.5, 0.5, 0.5), {.translation = {0.1, 0.2, 0.3}}), 0.125, 1e-14);
    EXPECT_NEAR(overlap_volume(*a, {}, *a, {}), 8, 1e-14);
    EXPECT_EQ(overlap_volume(*a, {}, *b, {.translation = {1.5, 0, 0}}), 0);
    EXPECT_EQ(overlap_volume(*a, {}, *b, {.translation = {3, 0, 0}}), 0);
    // An octagonal prism: a square and itself turned by 45 degrees share 8 (sqrt 2 - 1) of a half side squared.
    const double half = std::sqrt(0.5);
    const Pose turned{.rotation = {half, -half, 0, half, half, 0, 0, 0, 1}, .translation = {0, 0, 0.5}};
    EXPECT_NEAR(overlap_volume(*a, {}, *a, turned), 8 * (std::numbers::sqrt2 - 1) * 1.5, 1e-12);
}

TEST(OverlapVolume, OfASphereThatIsPressedIntoASlabIsItsCap) {
    const auto sphere = Shape::make(scenes::round_sphere(20000));
    const double radius = (sphere->box_max().z - sphere->box_min().z) / 2;
    const auto slab = box(4, 4, 4);
    for (const double depth : {0.02, 0.1, 0.4}) {
        const double cap = std::numbers::pi * depth * depth * (3 * radius - depth) / 3;
        const double found =
            overlap_volume(*sphere, {.translation = {0, 0, radius - depth}}, *slab, {.translation = {0, 0, -2}});
        EXPECT_NEAR(found, cap, 0.02 * cap) << depth; // its triangles lie inside the sphere
        EXPECT_LT(found, cap) << depth;
    }
}

// The sum runs over shadows along one axis: in another frame they are others, and the volume is the same.
TEST(OverlapVolume, DependsOnNoFrameAndNoOrder) {
    scenes::Random random(7);
    const std::shared_ptr<const Shape> all[] = {Shape::make(scenes::bumpy_torus(902)), Shape::make(scenes::knot(902)),
                                                Shape::make(scenes::star(902)), box(1, 1, 1)};
    double most = 0;
    for (int i = 0; i < 40; ++i) {
        const Shape &a = *all[i % 4], &b = *all[i / 4 % 4];
        const Pose pose_a = random_pose(random, 0.2), pose_b = random_pose(random, 0.2);
        const double volume = overlap_volume(a, pose_a, b, pose_b);
        most = std::max(most, volume);
        EXPECT_NEAR(overlap_volume(b, pose_b, a, pose_a), volume, 1e-13);
        const Pose frame = random_pose(random, 100);
        EXPECT_NEAR(overlap_volume(a, seen_from(frame, pose_a), b, seen_from(frame, pose_b)), volume, 1e-12);
        if (!intersects(a, pose_a, b, pose_b)) {
            EXPECT_LT(volume, 1e-13);
        }
    }
    EXPECT_GT(most, 0.01);
}

TEST(OverlapVolume, IsThatOfCgalsIntersection) {
    reference::Random random(11);
    scenes::Random places(12);
    int compared = 0;
    for (int i = 0; i < 120; ++i) {
        const auto a = Shape::make(i % 2 ? fine_solid(random) : coarse_solid(random));
        const auto b = Shape::make(coarse_solid(random));
        const double reach = 0.3 * (a->radius() + b->radius());
        const Pose pose_a = random_pose(places, reach), pose_b = random_pose(places, reach);
        const auto exact = shared_volume(*a, pose_a, *b, pose_b);
        if (!exact) continue;
        compared += *exact > 0;
        EXPECT_NEAR(overlap_volume(*a, pose_a, *b, pose_b), *exact,
                    1e-12 * (a->report().volume + b->report().volume) + 1e-13)
            << a->name() << " and " << b->name();
    }
    EXPECT_GT(compared, 40);
}

// Turned alike, by a pose or as files are, faces coincide up to rounding, which is different for each.
TEST(OverlapVolume, OfFlushBoxesTurnedAlikeIsThatOfTheirSides) {
    scenes::Random places(13);
    reference::Random random(13);
    for (int i = 0; i < 10000; ++i) {
        std::array<double, 3> size, shift;
        double expected = 1;
        for (std::size_t k = 0; k < 3; ++k) { // of b, whose faces are flush with a's on both sides, one, or none
            size[k] = random.below(2) == 0 ? 1 : 0.25 + 0.25 * random.below(3);
            const std::array at{(1 - size[k]) / 2, (size[k] - 1) / 2, 0.5, 0.3 * random.uniform(-1, 1)};
            shift[k] = at.at(random.below(4));
            expected *= std::max(0.0, std::min(0.5, shift[k] + size[k] / 2) - std::max(-0.5, shift[k] - size[k] / 2));
        }
        const Pose frame = random_pose(places, 10);
        Pose in_frame = frame;
        in_frame.translation = transform_point(frame, {shift[0], shift[1], shift[2]});
        const auto a = box(1, 1, 1), b = box(size[0], size[1], size[2]);
        ASSERT_NEAR(overlap_volume(*a, frame, *b, in_frame), expected, 1e-13) << i;
        const auto in_file = [](const Shape& shape, const Pose& pose) {
            Mesh mesh;
            mesh.vertices.assign(shape.file_vertices().begin(), shape.file_vertices().end());
            mesh.triangles.assign(shape.triangles().begin(), shape.triangles().end());
            return Shape::make(placed(mesh, pose));
        };
        ASSERT_NEAR(overlap_volume(*in_file(*a, frame), {}, *in_file(*b, in_frame), {}), expected, 1e-13) << i;
    }
}

// What float32 has of the vertices would be wrong by a seventh of the last of these.
TEST(OverlapVolume, IsThatOfTheFilesVertices) {
    const auto bar = [](double from, double to) {
        Mesh mesh = extruded("bar", rectangle(from, -0.3, to, 0.3), {}, -0.3, 0.3);
        return Shape::make(mesh);
    };
    for (const double depth : {1e-3, 1e-5, 1e-6, 1e-7, 1e-8})
        EXPECT_NEAR(overlap_volume(*bar(0.1, 1.3), {}, *bar(1.3 - depth, 2.7), {}), 0.36 * depth, 1e-16) << depth;
}

TEST(OverlapVolume, OfFlushPartsIsThatOfCgalsIntersection) {
    reference::Random random(14);
    scenes::Random places(15);
    int compared = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const double overlap = std::pow(10, random.uniform(-9, -1));
        const FlushPair pair =
            i % 5 < 4 ? flush_pair(i % flush_kinds, overlap, random) : fitted_pair(i % fitted_kinds, overlap, random);
        const Pose pose = i % 7 == 0 ? Pose{} : random_pose(places, 1);
        std::shared_ptr<const Shape> a, b;
        Pose frame;
        if (i % 3 == 0) {
            a = Shape::make(pair.a);
            b = Shape::make(pair.b);
            frame = pose;
        } else {
            const auto as_file = [&](const Mesh& mesh) { return i % 3 == 1 ? mesh : in_float32(mesh); };
            a = Shape::make(as_file(placed(pair.a, pose)));
            b = Shape::make(as_file(placed(pair.b, pose)));
        }
        const auto exact = shared_volume(*a, frame, *b, frame);
        if (!exact) continue;
        compared += *exact > 0;
        ASSERT_NEAR(overlap_volume(*a, frame, *b, frame), *exact, 1e-14 * (a->report().volume + b->report().volume))
            << i << " " << a->name() << " and " << b->name();
    }
    EXPECT_GT(compared, 800);
}

} // namespace
} // namespace raycontact::exact
