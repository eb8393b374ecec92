// SPDX-License-Identifier: Apache-2.0
#include <report/camera.h>

#include <scenes/quantile.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raycontact::report {
namespace {

Vec3 body_centre(const Shape& shape, const Pose& pose) {
    return transform_point(pose, shape.centre());
}

double half_diagonal(const Shape& shape) {
    const Vec3 low = shape.box_min(), high = shape.box_max();
    return std::sqrt((high.x - low.x) * (high.x - low.x) + (high.y - low.y) * (high.y - low.y)
                     + (high.z - low.z) * (high.z - low.z))
           / 2;
}

float median(const std::vector<Ball>& balls, float Float3::*axis) {
    std::vector<double> values;
    values.reserve(balls.size());
    for (const Ball& ball : balls) values.push_back(double(ball.centre.*axis));
    return static_cast<float>(scenes::quantile(std::move(values), 0.5));
}

/// A body that rolled far away must not make the pile small: strays are 2.5 times as far from the middle as most are.
std::vector<Ball> without_strays(std::vector<Ball> balls) {
    const Float3 middle{median(balls, &Float3::x), median(balls, &Float3::y), median(balls, &Float3::z)};
    const auto away = [&](const Ball& ball) { return length(ball.centre - middle); };
    std::sort(balls.begin(), balls.end(), [&](const Ball& a, const Ball& b) { return away(a) < away(b); });
    const float most = 2.5f * away(balls[balls.size() / 2]) + balls.front().radius;
    std::erase_if(balls, [&](const Ball& ball) { return away(ball) > most; });
    return balls;
}

/// Without those that fell off the ground, unless all did: most may have.
std::vector<Ball> on(const std::optional<Ground>& ground, std::vector<Ball> balls) {
    const auto is_off = [&](const Ball& ball) {
        return ball.centre.z + ball.radius < ground->height || !ground->holds(ball.centre);
    };
    if (ground && !std::ranges::all_of(balls, is_off)) std::erase_if(balls, is_off);
    return balls;
}

} // namespace

Stage make_stage(const scenes::RunLog& log, const scenes::Frame& frame) {
    Vec3 sum;
    double count = 0;
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        if (!log.body_moves[body]) continue;
        const Vec3 centre = body_centre(*log.shapes[log.body_shape[body]], frame.poses[body]);
        sum = {sum.x + centre.x, sum.y + centre.y, sum.z + centre.z};
        ++count;
    }
    Stage stage;
    // Whole metres, so that the ground's grid stays that of the world.
    if (count > 0) stage.origin = {std::floor(sum.x / count), std::floor(sum.y / count), std::floor(sum.z / count)};
    if (log.plane) {
        constexpr float inf = std::numeric_limits<float>::infinity();
        stage.ground = {place(stage, {0, 0, *log.plane}).z, {-inf, -inf}, {inf, inf}, std::nullopt};
    } else if (log.slab && *log.slab < frame.poses.size()) {
        const Shape& slab = *log.shapes[log.body_shape[*log.slab]];
        const Float3 low = place(stage, transform_point(frame.poses[*log.slab], slab.box_min()));
        const Float3 high = place(stage, transform_point(frame.poses[*log.slab], slab.box_max()));
        stage.ground = {high.z, {low.x, low.y}, {high.x, high.y}, *log.slab};
    }
    return stage;
}

Float3 place(const Stage& stage, const Vec3& world) {
    return {static_cast<float>(world.x - stage.origin.x), static_cast<float>(world.y - stage.origin.y),
            static_cast<float>(world.z - stage.origin.z)};
}

std::vector<Ball> moving_balls(const Stage& stage, const scenes::RunLog& log, const scenes::Frame& frame) {
    std::vector<Ball> balls;
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        if (!log.body_moves[body]) continue;
        const Shape& shape = *log.shapes[log.body_shape[body]];
        balls.push_back(
            {place(stage, body_centre(shape, frame.poses[body])), static_cast<float>(half_diagonal(shape))});
    }
    return balls;
}

Camera frame_balls(const std::vector<Ball>& all, const std::optional<Ground>& ground, std::uint32_t width,
                   std::uint32_t height) {
    Camera camera;
    camera.half_height = 0.25f; // a vertical field of view of 28 degrees
    camera.half_width = camera.half_height * static_cast<float>(width) / static_cast<float>(height);
    camera.forward = unit({-0.50f, 0.80f, -0.42f});
    camera.right = unit(cross(camera.forward, {0, 0, 1}));
    camera.up = cross(camera.right, camera.forward);
    const std::vector<Ball> balls =
        all.empty() ? std::vector<Ball>{{{0, 0, ground ? ground->height : 0}, 1}} : without_strays(on(ground, all));

    // Aim and distance by turns until the balls' extent on the picture is centred and fills it to 92 %.
    Float3 aim = balls.front().centre;
    float distance = 10;
    for (int turn = 0; turn < 40; ++turn) {
        camera.eye = aim - distance * camera.forward;
        float left = 1e9f, rightmost = -1e9f, low = 1e9f, high = -1e9f;
        for (const Ball& ball : balls) {
            const Float3 d = ball.centre - camera.eye;
            const float depth = std::max(dot(d, camera.forward), 0.1f * distance);
            const float reach = 0.75f * ball.radius; // the ball around a box is larger than what is in it
            left = std::min(left, (dot(d, camera.right) - reach) / depth);
            rightmost = std::max(rightmost, (dot(d, camera.right) + reach) / depth);
            low = std::min(low, (dot(d, camera.up) - reach) / depth);
            high = std::max(high, (dot(d, camera.up) + reach) / depth);
        }
        aim += (0.5f * (left + rightmost) * distance) * camera.right + (0.5f * (low + high) * distance) * camera.up;
        const float fill = std::max((rightmost - left) / camera.half_width, (high - low) / camera.half_height) / 2;
        distance *= 0.3f + 0.7f * fill / 0.92f;
    }
    camera.eye = aim - distance * camera.forward;
    if (ground) camera.eye.z = std::max(camera.eye.z, ground->height + 0.2f);
    return camera;
}

} // namespace raycontact::report
