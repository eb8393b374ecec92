// SPDX-License-Identifier: Apache-2.0
#include <scenes/region.h>

#include <gtest/gtest.h>

#include <cmath>

namespace raycontact::scenes {
namespace {

constexpr double inf = Region::inf;
const Vec3 down{0, 0, -9.81};

/// What a table of 4 x 2 m, 1 m high, and all above it is.
Region table(const Vec3& gravity) {
    Region region = Region::empty();
    region.include({-2, -1, 0});
    region.include({2, 1, 1});
    region.open_above(gravity);
    return region;
}

TEST(Region, BodiesOnItAreNotLost) {
    const Region region = table(down);
    for (const Vec3& p : {Vec3{0, 0, 1}, {2, 1, 0}, {-2, 0.5, 500}}) {
        EXPECT_FALSE(region.is_below(down, p));
        EXPECT_FALSE(region.has_left(down, p));
    }
}

TEST(Region, BodiesUnderItAndBesideItAre) {
    const Region region = table(down);
    EXPECT_TRUE(region.is_below(down, {0, 0, -0.1}));
    EXPECT_FALSE(region.has_left(down, {0, 0, -0.1}));
    EXPECT_TRUE(region.has_left(down, {2.1, 0, 0.5}));
    EXPECT_FALSE(region.is_below(down, {2.1, 0, 0.5}));
    EXPECT_TRUE(region.has_left(down, {2.1, 0, -343})); // past the edge
    EXPECT_TRUE(region.is_below(down, {2.1, 0, -343}));
    EXPECT_TRUE(region.has_left(down, {0, std::nan(""), 2}));
}

TEST(Region, DownIsWhereGravityPulls) {
    const Vec3 up{0, 0, 2}, along{5, 0, 0}, askew{0.1, 0, -9.81};
    EXPECT_TRUE(table(up).is_below(up, {0, 0, 30}));
    EXPECT_FALSE(table(up).is_below(up, {0, 0, -30}));
    EXPECT_TRUE(table(along).is_below(along, {30, 0, 0.5}));
    EXPECT_TRUE(table(along).has_left(along, {30, 0, 2}));
    EXPECT_TRUE(table(askew).is_below(askew, {0, 0, -5}));
    EXPECT_TRUE(table(askew).is_below(askew, {40, 0, -300}));
    EXPECT_FALSE(table(askew).is_below(askew, {0, 0, 5}));
}

TEST(Region, APlaneHasNoEdge) {
    Region plane = Region::empty();
    for (const double far : {-inf, inf}) plane.include({far, far, 0});
    for (const Vec3& gravity : {down, Vec3{0.5, 0, -9.81}}) {
        Region region = plane;
        region.open_above(gravity);
        EXPECT_TRUE(region.has_ground(gravity));
        EXPECT_TRUE(region.is_below(gravity, {1e6, 0, -1}));
        EXPECT_FALSE(region.is_below(gravity, {1e6, 0, 1}));
        EXPECT_FALSE(region.has_left(gravity, {1e6, -1e6, 1}));
    }
}

TEST(Region, WithoutGroundOrGravityNothingCanBeLost) {
    EXPECT_FALSE(Region().has_ground(down));
    EXPECT_TRUE(table(down).has_ground(down));
    EXPECT_FALSE(table({0, 0, 0}).has_ground({0, 0, 0}));
}

} // namespace
} // namespace raycontact::scenes
