// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "shape/shape_store.h"

#include <vector>

namespace raycontact {

/// Hits to contacts in the target's frame: count, scan, write; then over to the host.
class Gather {
public:
    /// Appends nothing that is no contact; the order is that of the rays. Returns how many side tests the hits needed.
    std::uint64_t run(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                      const Array<kernels::Ray>& rays, const Array<kernels::Hit>& hits,
                      std::vector<kernels::LocalContact>& contacts);

private:
    Scan scan_;
    Array<kernels::uint> counts_, sides_, firsts_;
    Array<kernels::LocalContact> contacts_;
};

} // namespace raycontact
