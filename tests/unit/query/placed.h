// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

namespace raycontact::reference {

inline Pose at(const Vec3& place) {
    return {.translation = place};
}
/// Turned at random, within so many metres of the origin.
inline Pose anywhere(Random& random, double spread) {
    Pose pose = random.rotation();
    pose.translation = spread * random.in_ball();
    return pose;
}

} // namespace raycontact::reference
