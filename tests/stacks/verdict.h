// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/stacks/stack.h>

#include <span>

namespace raycontact::scenes {

inline constexpr double drift_limit = 0.03; ///< of a body's size: the longest edge of its box
inline constexpr double turn_limit = 2;     ///< degrees

/// How far a stack has come from where it was put. Lengths are parts of the size of the body they are of.
struct Verdict {
    double drift = 0;   ///< the most, of the centre of mass, all axes
    double turn = 0;    ///< the most, degrees
    double sunk = 0;    ///< the most that a vertex is below z = 0
    double overlap = 0; ///< the most that two boxes overlap, of the smaller size (box_overlap)
    /// allowed: the drift of a stack that stands, at least drift_limit; allowed_turn: degrees.
    bool fell(const Stack& stack, double allowed = drift_limit, double allowed_turn = turn_limit) const;
};

/// By how much a relative pose turns, radians.
double angle_of(const Pose& moved);

Verdict judge(const Stack& stack, std::span<const Pose> poses);

} // namespace raycontact::scenes
