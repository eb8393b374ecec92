// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "device/staged.h"
#include "shape/shape_store.h"

#include <span>

namespace raycontact {

/// Hits to contacts in the target's frame: count, scan, write.
class Gather {
public:
    /// Returns how many side tests the hits needed.
    std::uint64_t run(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                      const Array<kernels::Ray>& rays, const Array<kernels::Hit>& hits);
    /// Of the last run, in the order of its rays; until the next.
    std::span<const kernels::LocalContact> contacts(Device& device) { return contacts_.read(device); }

private:
    Scan scan_;
    Array<kernels::uint> counts_, sides_, firsts_;
    Staged<kernels::LocalContact> contacts_;
};

} // namespace raycontact
