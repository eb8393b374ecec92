// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"
#include "slot_pair.h"

namespace raycontact {

/// World box of a body, metres.
struct WorldBox : Box {
    BodySlot body = 0;
    friend bool operator==(const WorldBox& a, const WorldBox& b) {
        return a.low == b.low && a.high == b.high && a.body == b.body;
    }
};

/// The box around a body-frame box that is widened by `grow` metres on every side, in the body frame, and then placed.
Box world_box(const Box& own, const Pose& pose, double grow);

} // namespace raycontact
