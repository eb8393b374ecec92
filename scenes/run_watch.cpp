// SPDX-License-Identifier: Apache-2.0
#include <scenes/run_watch.h>

#include <scenes/meshes_in_words.h>
#include <scenes/quantile.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace raycontact::scenes {

RunWatch::RunWatch(const SceneDescription& description)
    : scene_(description), hash_(description.settings.direction), depths_(description.depth_limit) {
    log_.scene = description.name;
    log_.arguments = description.arguments;
    log_.seed = description.seed;
    log_.dt = description.dt;
    log_.mesh_source = meshes_in_words(description);
    for (const SceneShape& shape : description.shapes) log_.shapes.push_back(shape.shape);
}

void RunWatch::add_body(const BodyStart& start, const Pose& pose) {
    log_.body_shape.push_back(start.shape);
    log_.body_moves.push_back(start.density > 0);
    positions_.push_back(pose.translation);
}

void RunWatch::add_step(double step_ms, const Scene& scene, std::span<const Pose> poses) {
    const auto found = scene.contacts();
    StepRow row;
    static_cast<StepStats&>(row) = scene.stats();
    row.step = steps();
    row.step_ms = step_ms;
    hash_.add(row.step, found);
    depths_.add(row.step, found);
    for (const Contact& c : found) row.penetration_max = std::max(row.penetration_max, static_cast<double>(c.depth));
    row.median_speed = median_speed(poses);
    keep_frame(row.step, poses);
    log_.rows.push_back(std::move(row));
}

// From positions: what the eye sees, with the corrections that Bullet keeps out of its velocities.
double RunWatch::median_speed(std::span<const Pose> poses) {
    std::vector<double> speeds;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (!log_.body_moves[i]) continue;
        const Vec3 now = poses[i].translation, &before = positions_[i];
        const Vec3 d{now.x - before.x, now.y - before.y, now.z - before.z};
        speeds.push_back(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) / log_.dt);
        positions_[i] = now;
    }
    return quantile(std::move(speeds), 0.5);
}

// Evenly over the planned run, its first and last step included.
void RunWatch::keep_frame(std::uint32_t step, std::span<const Pose> poses) {
    const std::uint64_t last = std::max(scene_.steps, 1u) - 1;
    const std::uint32_t frames = std::max(scene_.frames, 2u);
    for (std::uint32_t k = 0; k < frames; ++k) {
        if (step != last * k / (frames - 1)) continue;
        log_.frames.push_back({step, {poses.begin(), poses.end()}});
        return;
    }
}

Health RunWatch::health() const {
    Health h;
    const std::uint32_t second = steps_of_a_second(log_.dt);
    const std::uint32_t late = steps() > second ? steps() - second : 0;
    std::vector<double> late_speeds;
    for (const StepRow& row : log_.rows) {
        h.penetration_max = std::max(h.penetration_max, row.penetration_max);
        if (row.step >= late) late_speeds.push_back(row.median_speed);
    }
    h.median_speed_last_second = quantile(std::move(late_speeds), 0.5);
    h.depth_limit = depths_.limit();
    h.deep_contacts = depths_.contacts();
    h.deep_steps_longest = depths_.longest_since(0);
    h.deep_steps_last_second = depths_.longest_since(late);
    if (!scene_.region.has_ground(scene_.gravity)) return h;
    std::uint32_t below = 0, left = 0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        if (!log_.body_moves[i]) continue;
        below += scene_.region.is_below(scene_.gravity, positions_[i]);
        left += scene_.region.has_left(scene_.gravity, positions_[i]);
    }
    h.below_ground = below;
    h.flown_off = left;
    return h;
}

} // namespace raycontact::scenes
