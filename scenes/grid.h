// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/random.h>

#include <LinearMath/btTransform.h>

#include <cstdint>
#include <vector>

namespace raycontact::scenes {

/// Places in a cubic grid, filled from below, each a little off its place and a little tilted.
struct Grid {
    std::uint32_t places = 1;
    double spacing = 1; ///< metres
    double jitter = 0;  ///< most metres off along x and y
    double bottom = 0;  ///< height of the lowest layer, metres
    double tilt = 0.2;  ///< radians about each axis, at most or so

    /// Places along each edge: the least number whose cube holds all.
    std::uint32_t side() const;
    double top() const; ///< height of the highest layer, metres
    std::vector<btTransform> poses(Random& random) const;
};

} // namespace raycontact::scenes
