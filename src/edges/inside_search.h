// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/results.h"
#include "device/scan.h"
#include "pairs/update.h"

#include <span>
#include <vector>

namespace raycontact {

/// Finds on the device which directed pairs may have a component of the source inside the target. In float32: of pairs
/// whose surfaces do not cross all that have one (docs/internals/edges.md), and few others, whom the host has to tell
/// apart in double. Nothing waits.
class InsideSearch {
public:
    /// pairs: in which some slots may have no pair. totals[at]: how many were found.
    void find(const Update& update, const Array<kernels::DirectedPair>& pairs, const Array<kernels::Totals>& totals,
              std::size_t at);
    /// An argument of the read at the end of the step.
    Piece piece() { return found_.piece(); }
    /// After it, with its sum: false if there was too little room: there is enough now, and find() must run again.
    bool take(Device& device, const kernels::Totals& sum) { return found_.take(device, sum.sums[0]); }
    /// Places in `pairs`, rising.
    std::span<const kernels::uint> found() const { return found_.values(); }

    /// Then: for has(). directed(place in `pairs`): the directed index in a list of `pair_count` pairs.
    template <class Directed>
    void mark(Directed&& directed, std::size_t pair_count) {
        marks_.assign(pair_count, 0);
        for (const kernels::uint p : found()) marks_[directed(p) / 2] = 1;
    }
    /// Whether either body of the i-th pair of the list may have a part inside the other.
    bool has(std::size_t i) const { return marks_[i] != 0; }
    std::uint64_t bytes() const;

private:
    Columns counts_; ///< by directed pair: 1 or 0
    Results<kernels::uint> found_;
    std::vector<std::uint8_t> marks_; ///< by pair of the list
};

} // namespace raycontact
