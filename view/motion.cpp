// SPDX-License-Identifier: Apache-2.0
#include <view/motion.h>

#include <recording/viewer_part.h>
#include <view/blob.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact::view {

namespace {

struct Kept {
    std::array<double, 3> place{};
    std::array<double, 4> turn{0, 0, 0, 1};
};

Kept kept_of(const Pose& pose) {
    return {{pose.translation.x, pose.translation.y, pose.translation.z}, recording::quaternion(pose.rotation)};
}

/// Both signs of a quaternion are the same turn: takes the one nearer to that before.
void turn_near(const Kept& before, Kept& now) {
    double alike = 0;
    for (std::size_t k = 0; k < 4; ++k) alike += now.turn[k] * before.turn[k];
    if (alike < 0)
        for (double& part : now.turn) part = -part;
}

/// Of nothing yet.
void begin_box(Motion& motion) {
    motion.low.fill(std::numeric_limits<double>::infinity());
    motion.high.fill(-std::numeric_limits<double>::infinity());
}

void enclose(const Kept& kept, Motion& motion) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        motion.low[axis] = std::min(motion.low[axis], kept.place[axis]);
        motion.high[axis] = std::max(motion.high[axis], kept.place[axis]);
    }
}

/// Of all bodies and kept steps, body by body.
void write_numbers(const std::vector<Kept>& kept, Motion& motion) {
    if (!(motion.low[0] <= motion.high[0])) motion.low = motion.high = {};
    motion.numbers.resize(kept.size() * numbers_a_pose);
    for (std::size_t b = 0; b < motion.bodies; ++b)
        for (std::size_t i = 0; i < motion.kept; ++i) {
            const Kept& from = kept[b * motion.kept + i];
            std::uint16_t* const to = &motion.numbers[b * numbers_a_pose * motion.kept + i];
            for (std::size_t n = 0; n < numbers_a_pose; ++n) {
                const double extent = n < 3 ? motion.high[n] - motion.low[n] : 2;
                const double above = n < 3 ? from.place[n] - motion.low[n] : from.turn[n - 3] + 1;
                to[n * motion.kept] = quantised(extent > 0 ? above / extent : 0);
            }
        }
}

} // namespace

std::uint32_t stride_for(std::uint32_t bodies, std::uint32_t steps, std::uint64_t poses) {
    std::uint64_t stride = 1;
    while (bodies * ((steps + stride - 1) / stride) > poses && stride < steps) ++stride;
    return static_cast<std::uint32_t>(stride);
}

Motion read_motion(recording::Reader& reader, std::uint32_t stride,
                   const std::function<void(std::uint32_t)>& progress) {
    const std::vector<recording::Body>& bodies = reader.bodies();
    Motion motion;
    motion.stride = stride;
    motion.bodies = static_cast<std::uint32_t>(bodies.size());
    motion.kept = (reader.steps() + stride - 1) / stride;
    std::vector<Kept> kept(bodies.size() * motion.kept);
    for (const auto& body : bodies)
        motion.moves.push_back(std::min(body.end_step, reader.steps()) - body.first_step < 2);
    std::vector<Pose> poses, first(bodies.size());
    std::vector<Pair> pairs;
    begin_box(motion);
    for (std::uint32_t i = 0; i < reader.steps(); ++i) {
        // Every step: a body may come and go between two that are kept, and reading in order is cheap.
        reader.read_step(i, poses, pairs);
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            if (!bodies[b].alive(i)) continue;
            const Pose& pose = poses[bodies[b].id.slot];
            if (bodies[b].first_step == i) first[b] = pose;
            if (pose != first[b]) motion.moves[b] = true;
            if (i % stride != 0 && bodies[b].first_step != i) continue;
            const std::uint32_t at = i / stride;
            Kept now = kept_of(pose);
            Kept* const own = &kept[b * motion.kept];
            if (bodies[b].first_step == i) std::fill(own, own + at, now);
            turn_near(own[at == 0 ? 0 : at - 1], now);
            own[at] = now;
            enclose(now, motion);
        }
        if (progress) progress(i + 1);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::uint32_t end = std::min(bodies[b].end_step, reader.steps());
        if (end <= bodies[b].first_step) continue; // it came and went between two steps
        const auto last = kept.begin() + static_cast<std::ptrdiff_t>(b * motion.kept + (end - 1) / stride);
        std::fill(last, kept.begin() + static_cast<std::ptrdiff_t>((b + 1) * motion.kept), *last);
    }
    write_numbers(kept, motion);
    return motion;
}

Motion motion_of(const std::vector<std::vector<Pose>>& steps, std::uint32_t stride, const std::vector<bool>& moves) {
    Motion motion;
    motion.stride = stride;
    motion.kept = static_cast<std::uint32_t>(steps.size());
    motion.bodies = static_cast<std::uint32_t>(std::min(steps.back().size(), moves.size()));
    motion.moves.assign(moves.begin(), moves.begin() + motion.bodies);
    begin_box(motion);
    std::vector<Kept> kept;
    for (std::size_t b = 0; b < motion.bodies; ++b) {
        const auto has_come = [b](const std::vector<Pose>& poses) { return poses.size() > b; };
        const auto first = std::ranges::find_if(steps, has_come); // until then its pose is this one
        for (auto step = steps.begin(); step != steps.end(); ++step) {
            Kept now = kept_of((*std::max(step, first))[b]);
            if (step != steps.begin()) turn_near(kept.back(), now);
            enclose(kept.emplace_back(now), motion);
        }
    }
    write_numbers(kept, motion);
    return motion;
}

Motion standing(std::span<const Pose> poses) {
    Motion motion;
    motion.kept = 1;
    motion.bodies = static_cast<std::uint32_t>(poses.size());
    motion.moves.assign(poses.size(), false);
    begin_box(motion);
    std::vector<Kept> kept;
    for (const Pose& pose : poses) enclose(kept.emplace_back(kept_of(pose)), motion);
    write_numbers(kept, motion);
    return motion;
}

std::vector<std::uint16_t> differences(const Motion& motion) {
    std::vector<std::uint16_t> result = motion.numbers;
    for (std::size_t i = 1; i < result.size(); ++i)
        if (i % motion.kept != 0) result[i] = static_cast<std::uint16_t>(motion.numbers[i] - motion.numbers[i - 1]);
    return result;
}

} // namespace raycontact::view
