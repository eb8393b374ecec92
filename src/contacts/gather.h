// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/results.h"
#include "rays/ray_batch.h"

namespace raycontact {

/// Turns hits into contacts in the targets' frames, and reads them back at the end of a step, with the near edges.
class Gather {
public:
    /// Counts the contacts of a batch and writes them.
    void run(const Update& update, const RayBatch& batch);
    /// Waits for all launches, then reads the batch's sums, the contacts and, if asked for, the near edges. False if
    /// the contacts had too little room: there is enough now, and run() must write them again.
    bool read(Device& device, RayBatch& batch, Results<kernels::NearEdge>* near);
    /// After a step: frees memory that it hardly used.
    void give_back() { contacts_.give_back(); }
    /// In the order of their rays.
    std::span<const kernels::LocalContact> contacts() const { return contacts_.values(); }

private:
    Results<kernels::LocalContact> contacts_;
};

} // namespace raycontact
