// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/by_pair.h"
#include "pairs/near_edges.h"
#include "pairs/update.h"
#include "speculative/vertex_search.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// The speculative contacts of the vertices of all pairs (docs/internals/speculative.md).
class SpeculativeVertices {
public:
    /// touching: the contacts of vertices. asked: in the order of the pairs, with vertices for edges.
    void run(const Update& update, const ByPair<kernels::LocalContact>& touching, std::span<const AskedPair> asked);
    /// Of the i-th pair of the step.
    std::span<const FeatureContact> of(std::size_t i) const {
        return ends_.empty() ? std::span<const FeatureContact>()
                             : std::span(found_).subspan(ends_[i], ends_[i + 1] - ends_[i]);
    }
    void clear();

private:
    /// Some pairs.
    struct Block {
        std::vector<FeatureContact> found;
        std::array<std::vector<kernels::LocalContact>, 2> touching; ///< of one pair, by rising vertex
        VertexSearch search;
    };

    std::vector<Block> blocks_;
    std::vector<FeatureContact> found_; ///< in the order of the pairs
    std::vector<std::uint32_t> ends_;   ///< of the pair before, by pair
};

} // namespace raycontact
