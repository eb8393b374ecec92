// SPDX-License-Identifier: Apache-2.0
#include <report/stage.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact::report {
namespace {

std::array<double, 3> components(const Vec3& v) {
    return {v.x, v.y, v.z};
}

struct Box {
    std::array<double, 3> low{}, high{};
};

Box world_box(const Shape& shape, const Pose& pose) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
    for (const Vec3& v : shape.vertices()) {
        const auto p = components(transform_point(pose, v));
        for (std::size_t i = 0; i < 3; ++i) {
            box.low[i] = std::min(box.low[i], p[i]);
            box.high[i] = std::max(box.high[i], p[i]);
        }
    }
    return box;
}

/// As the slabs of scenes are: what is drawn as an endless plane must not have a shape of its own.
bool is_box(const Shape& shape) {
    return shape.vertices().size() == 8 && shape.triangles().size() == 12;
}

Vec3 body_centre(const Shape& shape, const Pose& pose) {
    return transform_point(pose, shape.centre());
}

double half_diagonal(const Shape& shape) {
    const Vec3 low = shape.box_min(), high = shape.box_max();
    return std::sqrt((high.x - low.x) * (high.x - low.x) + (high.y - low.y) * (high.y - low.y)
                     + (high.z - low.z) * (high.z - low.z))
           / 2;
}

} // namespace

Stage make_stage(const scenes::RunLog& log, const scenes::Frame& frame) {
    Stage stage;
    stage.is_ground.assign(frame.poses.size(), false);
    std::size_t up = 2;
    double widest = 0, ground_height = 0;
    std::vector<Box> drawn; // bodies that stand still and are drawn as they are
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        if (log.body_moves[body]) continue;
        const Shape& shape = *log.shapes[log.body_shape[body]];
        const Box box = world_box(shape, frame.poses[body]);
        std::array<double, 3> extent{};
        for (std::size_t i = 0; i < 3; ++i) extent[i] = box.high[i] - box.low[i];
        const auto thin = static_cast<std::size_t>(std::min_element(extent.begin(), extent.end()) - extent.begin());
        const double wide = std::min(extent[(thin + 1) % 3], extent[(thin + 2) % 3]);
        if (!is_box(shape) || wide < 2 * extent[thin]) { // a block, a post or anything with a shape of its own
            drawn.push_back(box);
            continue;
        }
        stage.is_ground[body] = true;
        if (wide > widest) {
            widest = wide;
            up = thin;
            ground_height = box.high[thin];
        }
    }
    if (log.plane) up = 2;
    stage.axes = {(up + 1) % 3, (up + 2) % 3, up};

    std::array<double, 3> sum{};
    double lowest = std::numeric_limits<double>::infinity(), count = 0;
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        if (!log.body_moves[body]) continue;
        const Shape& shape = *log.shapes[log.body_shape[body]];
        const auto centre = components(body_centre(shape, frame.poses[body]));
        for (std::size_t i = 0; i < 3; ++i) sum[i] += centre[i];
        lowest = std::min(lowest, centre[up] - half_diagonal(shape));
        ++count;
    }
    for (const Box& box : drawn) lowest = std::min(lowest, box.low[up]);
    // Whole metres, so that the ground's grid stays that of the world.
    if (count > 0) {
        stage.origin = {std::floor(sum[0] / count), std::floor(sum[1] / count), std::floor(sum[2] / count)};
        if (widest == 0) ground_height = lowest;
    }
    if (log.plane) ground_height = *log.plane;
    stage.ground = static_cast<float>(ground_height - components(stage.origin)[up]);
    return stage;
}

Float3 place(const Stage& stage, const Vec3& world) {
    const std::array<double, 3> p{world.x - stage.origin.x, world.y - stage.origin.y, world.z - stage.origin.z};
    return {static_cast<float>(p[stage.axes[0]]), static_cast<float>(p[stage.axes[1]]),
            static_cast<float>(p[stage.axes[2]])};
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

} // namespace raycontact::report
