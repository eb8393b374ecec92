// SPDX-License-Identifier: Apache-2.0
#include <report/camera.h>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace raycontact::report {
namespace {

std::vector<Ball> pile() {
    std::vector<Ball> balls;
    balls.reserve(24);
    for (const float z : {0.5f, 1.5f})
        for (const float y : {-1.0f, 0.0f, 1.0f})
            for (const float x : {-1.5f, -0.5f, 0.5f, 1.5f}) balls.push_back({{x, y, z}, 0.6f});
    return balls;
}

// How much of the picture's width or height the first `count` balls take, at most.
float filled(const Camera& camera, const std::vector<Ball>& balls, std::size_t count) {
    float most = 0;
    for (const auto& [axis, half] : {std::pair(camera.right, camera.half_width), {camera.up, camera.half_height}}) {
        float low = 1e9f, high = -1e9f;
        for (std::size_t i = 0; i < count; ++i) {
            const Float3 d = balls[i].centre - camera.eye;
            const float at = dot(d, axis) / dot(d, camera.forward) / half;
            low = std::min(low, at), high = std::max(high, at);
        }
        if (low < -1 || high > 1) return -1; // not in the picture
        most = std::max(most, (high - low) / 2);
    }
    return most;
}

TEST(Camera, FillsThePictureWithThePile) {
    const std::vector<Ball> balls = pile();
    EXPECT_GT(filled(frame_balls(balls, std::nullopt, 1280, 720), balls, 24), 0.5f);
}

TEST(Camera, LeavesOutAFewThatFlewAway) {
    std::vector<Ball> balls = pile();
    for (int i = 0; i < 10; ++i) balls.push_back({{8, 0, -90.0f - 30 * float(i)}, 0.6f});
    EXPECT_GT(filled(frame_balls(balls, std::nullopt, 1280, 720), balls, 24), 0.5f);
}

TEST(Camera, LeavesOutHoweverManyFellOffTheGround) {
    const Ground slab{0, {-4, -4}, {4, 4}, 0};
    std::vector<Ball> balls = pile();
    for (int i = 0; i < 100; ++i)
        balls.push_back({{i % 2 ? 2.0f : 60.0f, float(i % 7), i % 2 ? -90.0f - float(i) : 1.0f}, 0.6f});
    EXPECT_GT(filled(frame_balls(balls, slab, 1280, 720), balls, 24), 0.5f);
    // Where all did, they are shown.
    balls.erase(balls.begin(), balls.begin() + 24);
    const Camera camera = frame_balls(balls, slab, 1280, 720);
    EXPECT_EQ(filled(camera, balls, 1), 0); // in the picture
}

} // namespace
} // namespace raycontact::report
