// SPDX-License-Identifier: Apache-2.0
#include <report/stage.h>

#include <cmath>
#include <limits>

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

} // namespace raycontact::report
