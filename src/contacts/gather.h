// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rays/ray_batch.h"

#include <span>
#include <vector>

namespace raycontact {

/// Hits to contacts in the targets' frames, and the read that ends a step.
class Gather {
public:
    /// Counts the contacts of a batch and writes them.
    void run(const Update& update, const RayBatch& batch);
    /// Waits for all that was launched; reads the batch's sums and the contacts. False where the contacts had no room:
    /// there is more now, and they are to be written again.
    bool read(Device& device, RayBatch& batch);
    /// In the order of their rays.
    std::span<const kernels::LocalContact> contacts() const { return std::span(found_).first(count_); }

private:
    Array<kernels::LocalContact> contacts_;
    std::vector<kernels::LocalContact> found_; ///< only ever longer
    std::size_t count_ = 0;                    ///< of found_
    std::size_t expected_ = 0;                 ///< in the next step
};

} // namespace raycontact
