// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "round/round_contacts.h"

#include <optional>
#include <vector>

namespace raycontact {

/// A ball or capsule in the world.
struct MovingRound {
    Round round;
    Pose pose;
    std::optional<Pose> next; ///< where it is expected in the next step
};

/// Where two balls or capsules are nearest, or will touch, as round_contacts() has it with b as the obstacle: one
/// place, or both ends of the stretch along which two capsules lie beside each other. Of what is about to touch the one
/// that touches first, if both are expected somewhere; their ends go straight.
RAYCONTACT_API void two_round_contacts(const MovingRound& a, const MovingRound& b, double reach,
                                       std::vector<RoundContact>& out);

} // namespace raycontact
