// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/stage.h>

namespace raycontact::report {

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
