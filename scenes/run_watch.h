// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>
#include <raycontact/scene.h>
#include <scenes/depth_watch.h>
#include <scenes/description.h>
#include <scenes/health.h>
#include <scenes/run_log.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// What is measured of a simulation as it runs: its log, its hash, its sums, its health.
class RunWatch {
public:
    explicit RunWatch(const SceneDescription& description);

    /// A body comes: the next of the log's lists.
    void add_body(const BodyStart& start, const Pose& pose);
    /// A step is done: `scene` has found its contacts, and then the response moved the bodies to `poses`.
    void add_step(double step_ms, const Scene& scene, std::span<const Pose> poses);

    const RunLog& log() const { return log_; }
    Health health() const;
    std::uint32_t steps() const { return static_cast<std::uint32_t>(log_.rows.size()); }
    std::string hash() const { return hash_.hex(); }
    std::uint64_t contacts() const { return contacts_; }
    std::uint64_t rays() const { return rays_; }
    std::uint64_t pairs_max() const { return pairs_max_; }
    double ray_length() const { return ray_length_; } ///< metres

private:
    double median_speed(std::span<const Pose> poses);
    void keep_frame(std::uint32_t step, std::span<const Pose> poses);

    Region region_;
    Vec3 gravity_;
    std::uint32_t planned_steps_, frames_;
    RunLog log_;
    ContactHash hash_;
    DepthWatch depths_;
    std::uint64_t contacts_ = 0, rays_ = 0, pairs_max_ = 0;
    double ray_length_ = 0;
    std::vector<Vec3> positions_; ///< of the bodies at the end of the last step
};

} // namespace raycontact::scenes
