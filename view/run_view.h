// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <view/layers.h>
#include <view/motion.h>

#include <raycontact/scene.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raycontact::view {

/// What the view of a run shows, gathered while it runs: poses and contacts of some steps, evenly over the run, as many
/// as a report has room for. Nobody needs to know how long the run will be.
class RunView {
public:
    /// After each step. Bodies come in the order of their slots and stay.
    void add(const Scene& scene);

    std::uint32_t steps() const { return static_cast<std::uint32_t>(found_.pairs.size()); }
    const Found& found() const { return found_; }
    /// The step in which each body came.
    const std::vector<std::uint32_t>& first_steps() const { return first_steps_; }
    /// Of the bodies that had come by the last step that is kept. moves: of each body of the run.
    Motion motion(const std::vector<bool>& moves) const;

private:
    Found found_;
    std::vector<std::uint32_t> first_steps_;
    std::vector<std::vector<Pose>> poses_; ///< of every pose_stride_-th step
    std::uint32_t pose_stride_ = 1, layer_stride_ = 1;
    std::size_t poses_kept_ = 0, segments_kept_ = 0;
};

} // namespace raycontact::view
