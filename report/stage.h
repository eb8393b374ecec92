// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/vector.h>
#include <scenes/run_log.h>

#include <array>
#include <vector>

namespace raycontact::report {

/// How the world of a run is laid out for pictures: z up, origin among the bodies, where the ground is.
/// The axes are told from the bodies that do not move (the slab's thinnest axis is up), else z is up, as it is over an
/// endless plane.
struct Stage {
    std::array<std::size_t, 3> axes{0, 1, 2}; ///< world axis of each picture axis; a cyclic, so a proper, exchange
    Vec3 origin;                              ///< world frame, metres
    float ground = 0;                         ///< height of the ground, picture frame, metres
    std::vector<bool> is_ground; ///< per body of the frame: drawn as the endless ground plane, not as itself
};

Stage make_stage(const scenes::RunLog& log, const scenes::Frame& frame);

/// World to picture frame.
Float3 place(const Stage& stage, const Vec3& world);

/// Centre and radius of each moving body, picture frame.
struct Ball {
    Float3 centre;
    float radius = 0;
};
std::vector<Ball> moving_balls(const Stage& stage, const scenes::RunLog& log, const scenes::Frame& frame);

} // namespace raycontact::report
