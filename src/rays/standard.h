// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/device_pairs.h"
#include "rays/ray_batch.h"

#include <raycontact/scene.h>

namespace raycontact {

/// The standard method (paper section 2.1): one ray from every vertex inside the other body's bounds, unless a grid
/// knows that it is outside, cast in full. Nothing is read back: how much there is of anything stays on the device.
class StandardRays {
public:
    /// Brings the pairs up to date and casts their rays.
    void begin(const Update& update, RayBatch& batch);
    /// False where blocks or rays had no room: there is more now, and all is to be cast again.
    bool had_room(Device& device, RayBatch& batch);
    /// The same again.
    void cast(const Update& update, RayBatch& batch);
    void clear() { pairs_.clear(); }

    /// Adds what the last step did.
    static void count(const RayBatch& batch, std::size_t pairs, StepStats& stats);

private:
    DevicePairs pairs_;
    Columns block_counts_, ray_counts_;
    Array<kernels::ulong> block_masks_; ///< by pair: for a source of few blocks those found, a bit each
    Array<kernels::PairBlock> blocks_;
};

} // namespace raycontact
