// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"
#include "pairs/motion.h"
#include "pairs/pair_list.h"
#include "pairs/pair_slots.h"
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
    const SlotChanges& moved;
    const PairSlots& open; ///< all pairs of the part
    /// What is asked about, sorted, each once, and by the same index the slots: all that are open, or at least those
    /// that opened since the last step or have a body that moved. What the others had in the last step is kept. Devices
    /// with `standard` answer for all, asked or not.
    std::span<const SlotPair> pairs;
    std::span<const std::uint32_t> slots;
    const Motion& motion; ///< not up to date with `standard`, which does not use it
    const Settings& settings;

    /// Whether the edges near the other body are asked for.
    bool asks_near() const { return settings.features == Features::edges || settings.is_speculative(); }
    const ShapeStore::Arrays& arrays() const { return shapes.arrays(); }
    /// The same about other pairs.
    Update about(const PairList& list) const {
        return {device, executor, shapes, bodies, moved, open, list.pairs, list.slots, motion, settings};
    }
};

} // namespace raycontact
