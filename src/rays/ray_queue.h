// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "rays/block_finder.h"
#include "shape/shape_store.h"

namespace raycontact {

/// The rays of a step, dense, in the order of the pairs: one for each vertex of a source inside its target's bounds
/// that is not known to be outside the target.
class RayQueue {
public:
    /// use_grid: leave out the rays of vertices that a shape's grid knows to be outside; the contacts are the same.
    void fill(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
              bool use_grid);
    /// Without the blocks that are clear of the target by more than margins[p], metres of rounding (below 0:
    /// with all that reach into the bounds); the contacts are the same again. Vertices of theirs are counted nowhere.
    void fill_near(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                   const Array<float>& margins);

    const Array<kernels::Ray>& rays() const { return rays_; }
    std::uint64_t vertices_inside() const { return vertices_inside_; }
    std::uint64_t vertices_tested() const { return VERTEX_LANES * finder_.blocks().size(); }

private:
    void queue(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
               bool use_grid);

    BlockFinder finder_;
    Scan scan_;
    Array<kernels::uint> counts_, inside_, firsts_;
    std::uint64_t vertices_inside_ = 0;
    Array<kernels::Ray> rays_;
};

} // namespace raycontact
