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

/// Where two balls or capsules are nearest, as round_contacts() has it with b as the obstacle: one place, or both ends
/// of the stretch along which two capsules lie beside each other (places 0 and 1; else 2). If both are expected
/// somewhere, what touches on the way there, too: the axes, and each end by itself; ends go straight.
void two_round_contacts(const MovingRound& a, const MovingRound& b, double reach, std::vector<RoundContact>& out);

} // namespace raycontact
