// SPDX-License-Identifier: Apache-2.0
#include <raycontact/scene.h>

#include "reference/meshes.h"
#include "reference/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;

struct Placed {
    std::shared_ptr<const Shape> shape;
    Pose pose;
    BodyId body;
};

Vec3 scaled(double by, const Vec3& v) {
    return {by * v.x, by * v.y, by * v.z};
}

class SceneQueries : public testing::Test {
protected:
    SceneQueries() {
        const std::vector<std::shared_ptr<const Shape>> shapes{
            Shape::make(box_mesh({0.35, 0.1, 0.2})), Shape::make(bumpy_octahedron_mesh(3)), Shape::make(sheet_mesh(3))};
        for (std::size_t i = 0; i < 60; ++i) {
            const Pose pose = anywhere();
            placed_.push_back({shapes[i % 3], pose, scene_.add(shapes[i % 3], pose)});
        }
        scene_.remove(placed_[7].body);
        scene_.remove(placed_[30].body);
        placed_.erase(placed_.begin() + 30);
        placed_.erase(placed_.begin() + 7);
    }

    Pose anywhere() {
        Pose pose = random_.rotation();
        pose.translation = scaled(6, random_.in_ball());
        return pose;
    }
    /// A few or many, by turns; others come and go, and now and then a step is made.
    void move_some() {
        ++moves_;
        for (std::size_t i = moves_ % 2; i < placed_.size(); i += moves_ % 2 == 0 ? 2 : 17) {
            placed_[i].pose = anywhere();
            scene_.set_pose(placed_[i].body, placed_[i].pose);
        }
        if (moves_ % 3 == 0) {
            const std::size_t gone = 8 + moves_ % 20;
            scene_.remove(placed_[gone].body);
            placed_.erase(placed_.begin() + std::ptrdiff_t(gone));
        }
        Settings settings = scene_.settings();
        if (moves_ % 11 == 4) settings.speculative_margin = moves_ % 2 == 0 ? std::optional(0.05) : std::nullopt;
        settings.speculative = settings.speculative_margin.has_value() ? Speculative::on : Speculative::off;
        if (moves_ % 11 == 4) scene_.set_settings(settings);
        if (moves_ % 5 == 1) scene_.find_contacts();
        if (moves_ % 5 == 3) scene_.find_contacts(std::vector<Pair>{{placed_[0].body, placed_[1].body}});
        for (std::size_t i = 0; i < (moves_ == 9 ? 900u : moves_ % 4); ++i) {
            const auto shape = placed_[i % placed_.size()].shape;
            const Pose pose = anywhere();
            placed_.push_back({shape, pose, scene_.add(shape, pose)});
        }
        for (std::size_t i = 0; moves_ == 14 && i < 900; ++i) {
            scene_.remove(placed_.back().body);
            placed_.pop_back();
        }
        std::ranges::sort(placed_, {}, [](const Placed& p) { return p.body.slot; });
    }

    Random random_{41};
    Scene scene_;
    std::vector<Placed> placed_;
    std::size_t moves_ = 0;
};

TEST_F(SceneQueries, RaysMeetTheClosestBody) {
    int hits = 0, others = 0;
    for (int i = 0; i < 600; ++i) {
        if (i % 25 == 24) move_some();
        const Vec3 origin = scaled(9, random_.in_ball()), direction = random_.direction();
        const double max = i % 2 == 0 ? any_distance : 4;
        const auto none_of = [&](BodyId body) { return !(body == placed_[4].body) && !(body == placed_[5].body); };
        const Scene::Wanted wanted = i % 3 == 0 ? Scene::Wanted(none_of) : Scene::Wanted();
        std::optional<BodyRayHit> expected;
        for (const Placed& p : placed_) {
            if (wanted && !wanted(p.body)) continue;
            const auto hit = raycast(*p.shape, p.pose, origin, direction, max);
            if (!hit || (expected && hit->distance >= expected->distance)) continue;
            expected.emplace();
            static_cast<RayHit&>(*expected) = *hit;
            expected->body = p.body;
        }
        const auto found = scene_.raycast(origin, direction, max, wanted);
        ASSERT_EQ(found.has_value(), expected.has_value()) << i;
        ASSERT_EQ(scene_.raycast_any(origin, direction, max, wanted), expected.has_value()) << i;
        if (!found) continue;
        ++hits;
        others += !(found->body == placed_[0].body);
        EXPECT_TRUE(found->body == expected->body) << i;
        EXPECT_EQ(found->triangle, expected->triangle) << i;
        EXPECT_EQ(found->distance, expected->distance) << i;
    }
    EXPECT_GT(hits, 50);
    EXPECT_GT(others, 40);
}

TEST_F(SceneQueries, TheClosestPointIsThatOfTheNearestBody) {
    for (int i = 0; i < 300; ++i) {
        if (i % 15 == 14) move_some();
        const Vec3 point = scaled(9, random_.in_ball());
        std::optional<ClosestPoint> expected;
        BodyId body{};
        for (const Placed& p : placed_) {
            const auto near = closest_point(*p.shape, p.pose, point);
            if (expected && near->distance >= expected->distance) continue;
            expected = near;
            body = p.body;
        }
        const auto found = scene_.closest_point(point);
        ASSERT_TRUE(found);
        EXPECT_TRUE(found->body == body) << i;
        EXPECT_EQ(found->distance, expected->distance) << i;
        EXPECT_FALSE(scene_.closest_point(point, 0.9 * found->distance)) << i;
    }
}

TEST_F(SceneQueries, OverlapsAreTheBodiesThatIntersect) {
    const auto probe = Shape::make(box_mesh({1.1, 0.7, 0.3}));
    std::size_t overlapping = 0;
    for (int i = 0; i < 300; ++i) {
        if (i % 15 == 14) move_some();
        const Pose pose = anywhere();
        std::vector<BodyId> expected;
        for (const Placed& p : placed_)
            if (intersects(*p.shape, p.pose, *probe, pose)) expected.push_back(p.body);
        EXPECT_TRUE(scene_.overlaps(*probe, pose) == expected) << i;
        EXPECT_EQ(scene_.overlaps_any(*probe, pose), !expected.empty()) << i;
        overlapping += expected.size();
        const auto first = [&](BodyId body) { return !expected.empty() && body == expected[0]; };
        EXPECT_EQ(scene_.overlaps(*probe, pose, first).size(), expected.empty() ? 0u : 1u) << i;
        EXPECT_EQ(scene_.overlaps_any(*probe, pose, first), !expected.empty()) << i;
        const AxisBox box = placed_box(*probe, pose);
        for (const Vec3& v : probe->file_vertices()) {
            const Vec3 p = transform_point(pose, v);
            EXPECT_TRUE(p.x > box.low.x && p.y > box.low.y && p.z > box.low.z) << i;
            EXPECT_TRUE(p.x < box.high.x && p.y < box.high.y && p.z < box.high.z) << i;
        }
    }
    EXPECT_GT(overlapping, 50u);
}

TEST_F(SceneQueries, MayRunAtOnceAfterBodiesMoved) {
    move_some();
    const Vec3 origin{9, 0, 0}, direction{-1, 0.02, 0.01};
    std::vector<std::optional<BodyRayHit>> found(4);
    {
        std::vector<std::jthread> threads;
        for (auto& one : found) threads.emplace_back([&] { one = scene_.raycast(origin, direction); });
    }
    for (const auto& one : found) {
        ASSERT_EQ(one.has_value(), found[0].has_value());
        if (!one) continue;
        EXPECT_EQ(one->distance, found[0]->distance);
    }
}

TEST_F(SceneQueries, DistanceOfTwoBodies) {
    for (std::size_t i = 1; i < placed_.size(); ++i) {
        const Placed &p = placed_[0], &q = placed_[i];
        const auto expected = distance(*p.shape, p.pose, *q.shape, q.pose), found = scene_.distance(p.body, q.body);
        ASSERT_TRUE(expected && found);
        EXPECT_EQ(found->distance, expected->distance);
        EXPECT_EQ(found->point_a, expected->point_a);
    }
}

TEST_F(SceneQueries, RefuseBadInput) {
    EXPECT_THROW((void)scene_.raycast({}, {}), InputError);
    EXPECT_THROW((void)scene_.raycast({NAN, 0, 0}, {1, 0, 0}), InputError);
    EXPECT_THROW((void)scene_.raycast_any({}, {1, 0, 0}, -1), InputError);
    EXPECT_THROW((void)scene_.closest_point({INFINITY, 0, 0}), InputError);
    Pose twice;
    twice.rotation[0] = 2;
    EXPECT_THROW((void)scene_.overlaps(*placed_[0].shape, twice), InputError);
    const BodyId gone = placed_[3].body;
    scene_.remove(gone);
    EXPECT_THROW((void)scene_.distance(gone, placed_[0].body), InputError);
    EXPECT_THROW((void)Scene().raycast({}, {}), InputError);
    EXPECT_FALSE(Scene().raycast({}, {1, 0, 0}));
}

TEST_F(SceneQueries, WhatWantedThrowsPassesThrough) {
    const Scene::Wanted stop = [](BodyId) -> bool { throw std::out_of_range("stop"); };
    EXPECT_THROW((void)scene_.raycast({}, {1, 0, 0}, any_distance, stop), std::out_of_range);
    EXPECT_THROW((void)scene_.raycast_any({}, {1, 0, 0}, any_distance, stop), std::out_of_range);
    EXPECT_THROW((void)scene_.closest_point({}, any_distance, stop), std::out_of_range);
    EXPECT_THROW((void)scene_.overlaps(*placed_[0].shape, {}, stop), std::out_of_range);
}

} // namespace
} // namespace raycontact
