// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>
#include <raycontact/shape.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// Steps of `dt` seconds in a second, at least one.
inline std::uint32_t steps_of_a_second(double dt) {
    return dt < 1 ? static_cast<std::uint32_t>(std::lround(std::fmin(1 / dt, 1e9))) : 1;
}

/// One step of a simulation, as the report plots it.
struct StepRow : StepStats {
    std::uint32_t step = 0;
    double step_ms = 0;         ///< with the response
    double penetration_max = 0; ///< deepest contact, metres
    double median_speed = 0;    ///< of the moving bodies, m/s
};

/// Poses of the bodies there are at the end of a step, for comparisons. Body k is body k of the run's lists; those that
/// come later have no pose yet.
struct Frame {
    std::uint32_t step = 0;
    std::vector<Pose> poses;
};

/// All a report needs to know of a run.
struct RunLog {
    std::string scene;
    std::string arguments; ///< of `raycontact run`, that name this scene and its number of bodies
    std::uint64_t seed = 0;
    double dt = 1.0 / 60;
    std::vector<std::shared_ptr<const Shape>> shapes; ///< distinct shapes
    std::vector<std::uint32_t> body_shape;            ///< index into shapes, per body, in the order in which they came
    std::vector<bool> body_moves;                     ///< false for the ground
    std::vector<StepRow> rows;                        ///< one a step
    std::vector<Frame> frames;                        ///< a few, evenly over the run, the first and last included
    std::string mesh_source;                          ///< what the meshes are and where they came from, for a person
    std::string summary_json;                         ///< the object that `run --json` prints
};

} // namespace raycontact::scenes
