// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/first_meeting.h"

#include <raycontact/query.h>

#include <optional>

namespace raycontact {

/// With its first pose rigid. Throws InputError, which calls it `what`, where it is not sound.
RigidMotion checked_motion(const RigidMotion& given, const char* what);
/// Of two shapes, as time_of_impact() is asked. Throws InputError as that does.
Nearness checked_nearness(const Shape& a, const Shape& b, double distance, double tolerance);

/// From a to b, of two that are apart; unit, world frame. Of round bodies by their cores, which do not come near.
Vec3 normal_between(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, const Distance& apart);

/// Decided exactly.
std::optional<Impact> impact_at_start(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                      const Nearness& near);
/// Of two that are apart until `begin`, from then to `latest`. The motions are checked.
std::optional<Impact> impact_on_the_way(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                        const RigidMotion& motion_b, const Nearness& near, double begin = 0,
                                        double latest = 1);

} // namespace raycontact
