// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"

#include <raycontact/pose.h>

namespace raycontact {

/// The direction along which the convex hulls of two bodies are farthest apart, or least in each other, about: kept
/// from step to step, since it mostly serves again. A cull alone: what lies beyond the other body along it cannot
/// touch, and no contact is made of hulls.
class SeparatingNormal {
public:
    /// Metres by which the hulls are apart along it, at least; 0 or less where that is not known, as until both shapes
    /// have accelerators. Seeks a better direction where it is no more than `enough`. on_way: and stay so on their
    /// straight ways to the next step, each in the other's frame.
    double gap(const PlacedBody& a, const PlacedBody& b, double enough, bool on_way);

private:
    Vec3 normal_{}; ///< unit, from b to a, in b's frame; zero: none yet
};

} // namespace raycontact
