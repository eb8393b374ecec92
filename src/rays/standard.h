// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/device_pairs.h"
#include "rays/block_search.h"
#include "rays/ray_batch.h"

#include <raycontact/scene.h>

namespace raycontact {

/// The standard method (paper section 2.1): one ray from every vertex inside the other body's bounds, cast in full,
/// unless a grid knows that the vertex is outside. Nothing is read back: the numbers of blocks and rays stay on the
/// device.
class StandardRays {
public:
    /// Brings the pairs up to date and casts their rays.
    void begin(const Update& update, RayBatch& batch);
    /// False if blocks or rays had too little room: there is enough now, and cast() must run again.
    bool had_room(Device& device, RayBatch& batch);
    /// Finds and casts the rays again.
    void cast(const Update& update, RayBatch& batch);
    void clear() { pairs_.clear(); }
    const DevicePairs& pairs() const { return pairs_; }

    /// Adds what the last step did.
    void count(const RayBatch& batch, StepStats& stats) const;
    /// After a step: frees what the next makes anew.
    void trim() { search_ = BlockSearch(); }

private:
    DevicePairs pairs_;
    BlockSearch search_;
};

} // namespace raycontact
