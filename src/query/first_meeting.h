// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/moving_pair.h"

#include <cstdint>
#include <optional>

namespace raycontact {

/// Triangles that have come near, when, and their closest points in the centred frame of b at that time.
struct Meeting {
    double time;
    std::uint32_t a, b;
    Vec3 point_a, point_b;
};

/// What counts as near, metres: less than `distance`. It is told of triangles that are within `tolerance` of that.
struct Nearness {
    double distance, tolerance;
    /// To which searches advance: half of the tolerance before, so that the closest points keep a direction.
    double aim() const { return distance + 0.5 * tolerance; }
};

/// The first time from `begin` to `end` at which two surfaces are near; they are not before. Never late; the triangles
/// told are within distance + tolerance of each other then.
std::optional<Meeting> first_meeting(const MovingPair& pair, const Nearness& near, double begin, double end);

} // namespace raycontact
