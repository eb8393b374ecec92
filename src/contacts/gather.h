// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rays/ray_batch.h"

#include <span>
#include <vector>

namespace raycontact {

/// Turns hits into contacts in the targets' frames, and reads them back at the end of a step.
class Gather {
public:
    /// Counts the contacts of a batch and writes them.
    void run(const Update& update, const RayBatch& batch);
    /// Waits for all launches, then reads the batch's sums and the contacts. False if the contacts had too little room:
    /// there is enough now, and run() must write them again.
    bool read(Device& device, RayBatch& batch);
    /// After a step: frees memory that it hardly used.
    void give_back();
    /// In the order of their rays.
    std::span<const kernels::LocalContact> contacts() const { return std::span(found_).first(count_); }

private:
    Array<kernels::LocalContact> contacts_;
    std::vector<kernels::LocalContact> found_; ///< shrinks in give_back() alone
    std::size_t count_ = 0;                    ///< of found_
    std::size_t expected_ = 0;                 ///< in the next step, at most
};

} // namespace raycontact
