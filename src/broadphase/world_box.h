// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"

#include <limits>

namespace raycontact {

/// Touches nothing.
constexpr double infinitely_far = std::numeric_limits<double>::infinity();
constexpr Box no_box{{infinitely_far, infinitely_far, infinitely_far},
                     {-infinitely_far, -infinitely_far, -infinitely_far}};

/// The box around a body-frame box that is widened by `grow` metres on every side, in the body frame, and then placed.
Box world_box(const Box& own, const Pose& pose, double grow);

} // namespace raycontact
