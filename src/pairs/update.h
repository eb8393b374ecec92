// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "moved_bodies.h"
#include "pairs/directed_pairs.h"
#include "pairs/motion.h"
#include "shape/shape_store.h"

#include <raycontact/settings.h>

#include <span>

namespace raycontact {

/// What one step of one part works on. Valid for that step alone.
struct Update {
    Device& device;
    Executor& executor;
    const ShapeStore& shapes;
    std::span<const PlacedBody> bodies;
    const MovedBodies& moved;
    std::span<const SlotPair> pairs; ///< the part's: sorted, each once
    const Motion& motion;            ///< not up to date with `standard`, which does not use it
    const Settings& settings;
    /// What a pair had in the last step is kept: it need not be found again where neither body moved.
    bool may_rest = false;

    /// Whether the edges near the other body are asked for.
    bool asks_near() const { return settings.features == Features::edges || settings.is_speculative(); }
    const ShapeStore::Arrays& arrays() const { return shapes.arrays(); }
};

} // namespace raycontact
