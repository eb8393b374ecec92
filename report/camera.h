// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/vector.h>
#include <scenes/run_log.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raycontact::report {

/// The top of the slab, or the endless plane; picture frame, metres.
struct Ground {
    float height = 0;
    std::array<float, 2> low{}, high{}; ///< along x and y; infinite: a plane
    std::optional<std::size_t> body;    ///< the slab, of which nothing else is drawn; turned it is not

    bool holds(Float3 p) const { return p.x >= low[0] && p.x <= high[0] && p.y >= low[1] && p.y <= high[1]; }
};

/// How the world of a run is laid out for pictures: origin among the bodies, and the ground, if there is one.
struct Stage {
    Vec3 origin; ///< world frame, metres
    std::optional<Ground> ground;
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

/// A pinhole; picture frame, metres. Ray through (u, v), both in [0, 1] from the top left: see direction().
struct Camera {
    Float3 eye, forward, right, up;
    float half_width = 1, half_height = 1; ///< of the picture at distance 1

    Float3 direction(float u, float v) const {
        return unit(forward + ((2 * u - 1) * half_width) * right + ((1 - 2 * v) * half_height) * up);
    }
};

/// Looks down on the balls from one side, near enough that all but strays, and those that fell off the ground, just
/// fill the picture.
Camera frame_balls(const std::vector<Ball>& balls, const std::optional<Ground>& ground, std::uint32_t width,
                   std::uint32_t height);

} // namespace raycontact::report
