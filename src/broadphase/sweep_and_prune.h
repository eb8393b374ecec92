// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"
#include "slot_pair.h"

#include <vector>

namespace raycontact {

/// World box of a body, metres.
struct WorldBox : Box {
    BodySlot body = 0;
};

/// The box around a body-frame box that is widened by `grow` metres on every side, in the body frame, and then placed.
Box world_box(const Box& own, const Pose& pose, double grow);

/// Sweep and prune along the axis on which the boxes lie farthest apart: O(n log n) plus the overlaps on that axis.
/// Touching boxes count. The result is sorted and does not depend on the order of the input.
void sweep_and_prune(std::vector<WorldBox>& boxes, std::vector<SlotPair>& pairs);

} // namespace raycontact
