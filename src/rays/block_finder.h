// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "shape/shape_store.h"

namespace raycontact {

/// The vertex blocks of each pair that may reach into its bounds, in the order of the pairs.
class BlockFinder {
public:
    void find(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs);
    /// Without those that cannot be in contact before they have moved by horizons[p], metres, which hold the rounding
    /// to be allowed for; below 0: as find().
    void find_near(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                   const Array<float>& horizons);

    Array<kernels::Cluster>& blocks() { return blocks_; }
    const Array<kernels::Cluster>& blocks() const { return blocks_; }
    // By pair: how many, and where they begin.
    const Array<kernels::uint>& counts() const { return counts_; }
    const Array<kernels::uint>& firsts() const { return firsts_; }
    /// Of find_near(), by pair: where it has no block, how far its vertices can move before one could be in contact,
    /// metres, rounding not allowed for. May be less, also negative.
    const Array<float>& clears() const { return clears_; }

private:
    Scan scan_;
    Array<kernels::uint> counts_, firsts_;
    Array<float> clears_;
    Array<kernels::ulong> small_; ///< blocks that a small source reaches, a bit each
    Array<kernels::Cluster> blocks_;
};

} // namespace raycontact
