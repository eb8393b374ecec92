// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "shape/shape_store.h"

namespace raycontact {

/// The rays of a step, dense: one for each vertex of a source inside its target's bounds, in the order of the pairs.
class RayQueue {
public:
    void fill(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs);

    const Array<kernels::Ray>& rays() const { return rays_; }
    std::uint64_t vertices_tested() const { return VERTEX_LANES * clusters_.size(); }

private:
    Scan scan_;
    Array<kernels::uint> counts_, firsts_;
    Array<kernels::Cluster> clusters_;
    Array<kernels::Ray> rays_;
};

} // namespace raycontact
