// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/by_pair.h"
#include "pairs/range_pool.h"
#include "rays/edge_rays.h"
#include "rays/wake_up.h"

namespace raycontact {

/// The near edges that the certified method keeps of its pairs. They were sought some way beyond what is needed, and
/// last until the pair has moved that far (docs/certified.md). Needs memory that host and device share.
class EdgeLists {
public:
    /// Seeks those that are due in this step, by slices; of pairs in contact only those that are not short, until it is
    /// in contact no more. Uses the batch's sums of edges.
    void find(const Update& update, std::span<const WakeUp::Slice> slices, WatchedPairs& table,
              const ByPair<kernels::LocalContact>& contacts, RayBatch& batch);
    std::array<std::span<kernels::NearEdge>, 2> of(const KeptEdges& kept) {
        const std::span all = std::span(edges_).subspan(kept.first, kept.count());
        return {all.first(kept.counts[0]), all.subspan(kept.counts[0])};
    }
    void release(KeptEdges& kept) {
        pool_.release({kept.first, kept.capacity});
        kept = {};
    }
    void clear();

    std::uint64_t bytes() const;
    /// After a step: frees memory that it hardly used. Not what is kept.
    void give_back();

private:
    struct Search {
        DueEdges due;
        float least; ///< metres: edges that are shorter are left out
    };
    void find(const Update& update, std::span<const Search> due, WatchedPairs& table, RayBatch& batch);

    std::vector<Search> due_;
    std::vector<std::uint32_t> directed_; ///< 0, 1, 2 and so on
    Array<kernels::DirectedPair> pairs_;  ///< both directions of some of those due
    Array<kernels::DirectedPair> next_;   ///< where they will be, if any moves
    Array<float> margins_, ahead_, least_;
    EdgeRays rays_;
    ByPair<kernels::NearEdge> found_;
    RangePool pool_;
    std::vector<kernels::NearEdge> edges_;
};

} // namespace raycontact
