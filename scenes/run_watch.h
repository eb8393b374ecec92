// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>
#include <raycontact/scene.h>
#include <scenes/depth_watch.h>
#include <scenes/description.h>
#include <scenes/run_log.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// How well the bodies of a run behave; over the whole run unless said otherwise.
struct Health {
    double penetration_max = 0;               ///< deepest contact, metres
    double depth_limit = 0;                   ///< SceneDescription::depth_limit
    std::uint64_t deep_contacts = 0;          ///< contacts deeper than the limit, summed over the steps
    std::uint32_t deep_steps_longest = 0;     ///< most steps in a row that one contact (same key) was deeper
    std::uint32_t deep_steps_last_second = 0; ///< the same, of runs that reach into the last second
    double median_speed_last_second = 0; ///< over the bodies, and of these medians over the last second's steps, m/s
    /// Bodies whose centre of mass is now under the region, and beside or above it; one that fell past an edge is both.
    /// Nothing where the scene has no ground.
    std::optional<std::uint32_t> below_ground, flown_off;
};

/// What is measured of a simulation as it runs: its log, its hash, its health.
class RunWatch {
public:
    /// The description must outlive it.
    explicit RunWatch(const SceneDescription& description);

    /// A body comes: the next of the log's lists.
    void add_body(const BodyStart& start, const Pose& pose);
    /// A step is done: `scene` has found its contacts, and then the response moved the bodies to `poses`.
    void add_step(double step_ms, const Scene& scene, std::span<const Pose> poses);

    const RunLog& log() const { return log_; }
    Health health() const;
    std::uint32_t steps() const { return static_cast<std::uint32_t>(log_.rows.size()); }
    std::string hash() const { return hash_.hex(); }

private:
    double median_speed(std::span<const Pose> poses);
    void keep_frame(std::uint32_t step, std::span<const Pose> poses);

    const SceneDescription& scene_;
    RunLog log_;
    ContactHash hash_;
    DepthWatch depths_;
    std::vector<Vec3> positions_; ///< of the bodies at the end of the last step
};

} // namespace raycontact::scenes
