// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/by_pair.h"
#include "pairs/range_pool.h"
#include "rays/due_pairs.h"
#include "rays/near_rays.h"

namespace raycontact {

/// The near edges, or the near vertices, that the certified method keeps of its pairs. They were sought some way beyond
/// what is needed, and last until the pair has moved that far (docs/internals/certified.md). Needs memory that host and
/// device share.
class NearLists {
public:
    struct Search {
        std::uint32_t pair;   ///< its place
        float margin, ahead;  ///< metres beyond what is needed that they are sought; beyond that, that bounds are
        float speculative;    ///< of what is needed: metres within which they have speculative contacts
        float least;          ///< metres: edges that hide less may be left out (docs/internals/edges.md)
        float least_ahead;    ///< metres: edges that hide less have speculative contacts with edges that hide more, and
                              ///< are found near these; 0: all of a are sought
        bool moves;           ///< what they come near on their way to the next step is needed
        float reach = 1;      ///< as KeptNear, of the last list
        bool is_wide = false; ///< sought as far as nothing may be near
    };
    NearLists(BlockSearch::Sources sources, KeptNear CertifiedPair::*kept, double Slack::*slack)
        : rays_(sources), kept_(kept), slack_(slack) {}

    /// Uses the batch's sums of edges, or of points.
    void find(const Update& update, std::span<const Search> due, CertifiedPairs& table, RayBatch& batch);
    std::array<std::span<kernels::NearEdge>, 2> of(const CertifiedPair& pair) {
        const KeptNear& kept = pair.*kept_;
        const std::span all = std::span(edges_).subspan(kept.first, kept.count());
        return {all.first(kept.counts[0]), all.subspan(kept.counts[0])};
    }
    void release(CertifiedPair& pair) {
        pool_.release({(pair.*kept_).first, (pair.*kept_).capacity});
        pair.*kept_ = {};
    }
    void clear();

    std::uint64_t bytes() const;
    /// After a step: frees what the next makes anew.
    void trim();

private:
    void find_some(const Update& update, std::span<const Search> due, CertifiedPairs& table, RayBatch& batch);

    Array<kernels::DirectedPair> pairs_; ///< both directions of some of those due
    Array<kernels::DirectedPair> next_;  ///< where they will be, if any moves
    Array<float> margins_, ahead_;
    Array<kernels::EdgeChoice> choices_;
    NearRays rays_;
    KeptNear CertifiedPair::*kept_;
    double Slack::*slack_;
    ByPair<kernels::NearEdge> found_;
    RangePool pool_;
    std::vector<kernels::NearEdge> edges_;
};

} // namespace raycontact
