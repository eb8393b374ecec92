// SPDX-License-Identifier: Apache-2.0
// Points of clashes: one in both parts, one on the surface of either; against rational numbers.
#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "exact/rational_mesh.h"

#include <raycontact/clash.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::exact {
namespace {

using reference::Random;

struct Seen {
    int clashes = 0, deep = 0;
};

/// Whether the points that a clash of two parts tells lie where they should, to 1e-12 of the part's size.
void ask(const Mesh& a, const Mesh& b, const Pose& pose_b, Seen& seen) {
    std::vector<AssemblyPart> parts(2);
    parts[0].name = "first";
    parts[0].mesh = std::make_shared<Mesh>(a);
    parts[1].name = "second";
    parts[1].mesh = std::make_shared<Mesh>(b);
    parts[1].pose = pose_b;
    const auto clashes = find_clashes(parts).clashes;
    const auto shape_a = Shape::make(a), shape_b = Shape::make(b);
    ASSERT_EQ(clashes.size(), intersects(*shape_a, {}, *shape_b, pose_b) ? 1u : 0u);
    if (clashes.empty()) return;
    const Clash& clash = clashes[0];
    ++seen.clashes;
    seen.deep += clash.contacts > 0;
    const RationalMesh exact_a(*shape_a), exact_b(*shape_b, pose_b);
    const double small = 1e-12 * std::max(shape_a->radius(), shape_b->radius());
    const std::string words = a.name + " and " + b.name + ", " + std::to_string(clash.contacts) + " contacts";
    EXPECT_TRUE(contains(*shape_a, clash.point) || exact_a.closest(clash.point).distance < small) << words;
    EXPECT_TRUE(contains(*shape_b, pose_b, clash.point) || exact_b.closest(clash.point).distance < small) << words;
    if (clash.contacts == 0) {
        EXPECT_EQ(clash.point_a, clash.point);
        EXPECT_EQ(clash.point_b, clash.point);
        return;
    }
    EXPECT_LT(exact_a.closest(clash.point_a).distance, small) << words;
    EXPECT_LT(exact_b.closest(clash.point_b).distance, small) << words;
}

Pose pose_at(Random& random, double reach) {
    Pose pose = random.rotation();
    const Vec3 at = random.in_ball();
    pose.translation = {reach * at.x, reach * at.y, reach * at.z};
    return pose;
}

TEST(ClashPoints, OfPartsAnyhow) {
    Random random(41);
    Seen seen;
    for (int i = 0; i < 1500; ++i) {
        const Mesh a = coarse_solid(random), b = coarse_solid(random);
        const double reach = Shape::make(a)->radius() + Shape::make(b)->radius();
        ASSERT_NO_FATAL_FAILURE(ask(a, b, pose_at(random, 0.6 * reach), seen));
    }
    EXPECT_GT(seen.deep, 600);
}

TEST(ClashPoints, OfPartsThatTouchAreFlushOrFitted) {
    Random random(42);
    Seen seen;
    for (std::uint32_t i = 0; i < 1500; ++i) {
        const double overlap = i % 4 == 0 ? 0 : std::pow(10, random.uniform(-9, -1));
        const FlushPair pair =
            i % 5 < 4 ? flush_pair(i % flush_kinds, overlap, random) : fitted_pair(i % fitted_kinds, overlap, random);
        const Pose frame = i % 3 == 0 ? Pose{} : pose_at(random, 1);
        ASSERT_NO_FATAL_FAILURE(ask(placed(pair.a, frame), placed(pair.b, frame), {}, seen));
    }
    EXPECT_GT(seen.clashes, 1200);
    EXPECT_GT(seen.deep, 500);
}

// Two prisms, one on the other, turned by half a turn: their caps cross like a star.
TEST(ClashPoints, OfCapsThatCrossLikeAStar) {
    Seen seen;
    const Mesh a = extruded("a", {{0, 0}, {4, 0}, {2, 3}}, {}, 0, 1),
               b = extruded("b", {{0, 2}, {2, -1}, {4, 2}}, {}, 1, 2);
    ask(a, b, {}, seen);
    EXPECT_EQ(seen.clashes, 1);
    EXPECT_EQ(seen.deep, 0);
}

} // namespace
} // namespace raycontact::exact
