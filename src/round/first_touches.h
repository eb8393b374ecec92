// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "round/surroundings.h"

#include <vector>

namespace raycontact {

/// A spot that is not there yet.
struct FirstTouch {
    Spot spot;         ///< as it is when it is touched
    double into = 0;   ///< how far the rest of the way would lead beyond the surface, metres
    double length = 0; ///< of that rest
};

/// Whether a way goes against a normal at more than a thousandth: else it leads along the surface.
bool leads_into(const Vec3& way, const Vec3& normal);

/// What a ball or capsule touches on its way and does not touch yet, as it is then: in the order in which it comes,
/// each time going on along what is touched, without friction or rebound. In closed form: the time at which an end or
/// the axis, whose ends go straight, is so far from a face, edge or corner is the root of a polynomial. True if it
/// has gone all the way.
bool find_first_touches(Surroundings& surroundings, std::vector<FirstTouch>& touched);

} // namespace raycontact
