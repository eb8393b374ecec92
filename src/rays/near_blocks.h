// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "pairs/update.h"

namespace raycontact {

/// The vertex blocks of some pairs that could be in contact soon, in the order of the pairs.
class NearBlocks {
public:
    /// Finds the blocks of the first horizons.size() pairs that could be in contact before they have moved by
    /// horizons[p] (metres, rounding included). horizons[p] < 0: all blocks that reach into the bounds. Uses
    /// totals[at]. Waits for the device once.
    void find(const Update& update, const Array<kernels::OrderedPair>& pairs, const Array<float>& horizons,
              const Array<kernels::Totals>& totals, std::size_t at);

    const Array<kernels::PairBlock>& blocks() const { return blocks_; }
    /// By pair: where its blocks begin.
    const Array<kernels::uint>& firsts() const { return counts_.firsts(); }
    /// By pair: how many there are.
    std::span<const kernels::uint> host_counts() const { return host_counts_; }
    /// By pair, if it has no block: how far its vertices can move before one could be in contact, metres, rounding not
    /// included. May be less, also negative.
    std::span<const float> host_safe_distances() const { return host_safe_distances_; }

private:
    Columns counts_;
    Array<float> safe_distances_;
    Array<kernels::ulong> block_masks_; ///< by pair: for a source of few blocks those found, a bit each
    Array<kernels::PairBlock> blocks_;
    std::vector<kernels::uint> host_counts_;
    std::vector<float> host_safe_distances_;
};

} // namespace raycontact
