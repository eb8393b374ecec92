// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

#include <raycontact/mesh.h>

// Parts in each other's corners, as they are drawn: bars in angles, keys in slots, combs in combs. Metres.
namespace raycontact::exact {

/// Two parts that come apart by a small move.
struct CornerPair {
    Mesh a, b;
    Pose pose_b;    ///< in the frame of a
    double way = 0; ///< b comes apart from a by some move no longer than this, metres
};

constexpr const char* corner_families[] = {"bar in an angle",
                                           "angle on an edge",
                                           "angle on an angle",
                                           "bar in a channel",
                                           "wide bar in a channel",
                                           "key in a slot",
                                           "dovetail",
                                           "saw teeth",
                                           "cube in a tray",
                                           "cone in a cap",
                                           "half shell on a rod",
                                           "stairs",
                                           "combs",
                                           "half lap",
                                           "notch on an edge"};

/// The i-th of a family: aligned or tilted by up to 0.3 degrees, shorter, longer and flush, edges cut and whole.
CornerPair corner_pair(std::size_t family, reference::Random& random);

/// Wedges of this half angle (degrees) that lie ridge on ridge, turned by `turn` turns, by `overlap` in each other.
CornerPair crossed_ridges(double half_angle, double turn, double overlap, reference::Random& random);

} // namespace raycontact::exact
