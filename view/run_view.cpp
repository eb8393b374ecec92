// SPDX-License-Identifier: Apache-2.0
#include <view/run_view.h>

#include <utility>

namespace raycontact::view {

namespace {

// At most some five megabytes of page, two to three of an avalanche.
constexpr std::size_t most_poses = 200'000, most_segments = 100'000, most_layers = 64;

std::size_t size_of(const std::vector<Pose>& poses) {
    return poses.size();
}

std::size_t size_of(const LayerStep& layer) {
    return layer.contacts.size() + layer.predictions.size();
}

/// Leaves out every second one; returns the size of those that stay.
template <class Kept>
std::size_t halve(std::vector<Kept>& kept) {
    std::size_t size = 0, to = 0;
    for (std::size_t from = 0; from < kept.size(); from += 2, ++to) {
        if (to != from) kept[to] = std::move(kept[from]);
        size += size_of(kept[to]);
    }
    kept.resize(to);
    return size;
}

} // namespace

// As the scene has them, which found its contacts there; the response has moved the bodies on since.
void RunView::add(const Scene& scene) {
    const std::uint32_t step = steps();
    first_steps_.resize(scene.body_count(), step);
    if (step % pose_stride_ == 0) {
        std::vector<Pose>& poses = poses_.emplace_back();
        for (std::uint32_t slot = 0; slot < scene.body_count(); ++slot) poses.push_back(scene.pose(BodyId{slot}));
        poses_kept_ += poses.size();
        for (; poses_kept_ > most_poses && poses_.size() > 1; pose_stride_ *= 2) poses_kept_ = halve(poses_);
    }
    const bool with_layer = step % layer_stride_ == 0;
    found_.add(scene, with_layer);
    if (!with_layer) return;
    segments_kept_ += size_of(found_.layers.back());
    for (; (segments_kept_ > most_segments || found_.layers.size() > most_layers) && found_.layers.size() > 1;
         layer_stride_ *= 2)
        segments_kept_ = halve(found_.layers);
}

Motion RunView::motion(const std::vector<bool>& moves) const {
    return motion_of(poses_, pose_stride_, moves);
}

} // namespace raycontact::view
