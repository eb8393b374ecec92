// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/by_pair.h"
#include "pairs/range_pool.h"
#include "rays/block_search.h"
#include "rays/due_pairs.h"
#include "rays/near_lists.h"
#include "rays/ray_batch.h"

#include <raycontact/scene.h>

namespace raycontact {

/// The rays of a step by the certified method: those of `standard` that could be contacts, and hardly any other
/// (docs/internals/certified.md). Each directed pair candidates the vertex blocks within some distance of its target. A
/// block, and a pair, is due once the pair has moved as far as the nearest vertex was from touching. Pairs for which
/// this does not pay off are left to `standard`. Needs memory that host and device share.
class CertifiedRays {
public:
    /// The hits are those of `standard`; most of these rays are not cast (with caster basic all are).
    void cast(const Update& update, RayBatch& batch);
    /// Then, when the contacts of vertices are known, the near vertices, for speculative contacts.
    void find_points(const Update& update, RayBatch& batch);
    /// Then, when those of vertices are known, the near edges.
    void find_edges(const Update& update, const ByPair<kernels::LocalContact>& contacts, RayBatch& batch);
    void clear();

    /// Of the i-th pair that is asked about: its near edges, and what is known while they last (AskedPair).
    std::array<std::span<kernels::NearEdge>, 2> near(std::size_t i) { return edges_.of(table_.state(i)); }
    bool has_points(std::size_t i) { return table_.hot(i).has_points; }
    std::array<std::span<kernels::NearEdge>, 2> points(std::size_t i) { return points_.of(table_.state(i)); }
    bool is_apart(std::size_t i) { return table_.hot(i).apart; }
    bool* apart(std::size_t i) { return &table_.hot(i).apart; }

    /// Adds what the last step did.
    void count(const RayBatch& batch, StepStats& stats) const;
    /// After a step: frees what the next makes anew.
    void trim();

private:
    struct Stale {
        DuePairs::Slice* slice;
        std::uint32_t at; ///< index in slice->due
        Due& due() const { return slice->due[at]; }
    };

    static NearLists::Search search_of(const DueNear& due, const KeptNear& kept, bool moves, double margin);
    void close(CertifiedPair& state);
    void list_slices();
    void make_lists(const Update& update, RayBatch& batch, std::span<const Stale> stale);
    void place(const Update& update);
    void find_standard_rays(const Update& update, RayBatch& batch);
    void test_candidates(const Update& update, RayBatch& batch);
    void write_rays(const Update& update, RayBatch& batch);
    void settle(const Update& update, std::uint32_t first_ray);
    void decide(const Update& update, RayBatch& batch);

    CertifiedPairs table_;
    DuePairs due_pairs_;
    NearLists edges_{BlockSearch::Sources::edges, &CertifiedPair::edges, &Slack::edges};
    NearLists points_{BlockSearch::Sources::points, &CertifiedPair::points, &Slack::points};
    std::vector<NearLists::Search> searches_;
    RangePool pool_;
    std::vector<Stale> stale_;
    std::vector<std::uint32_t> directed_; ///< directed indices of the batch: pairs left to `standard`, then what is due
    std::size_t standard_count_ = 0;      ///< of directed_
    kernels::Totals standard_sums_{};     ///< of pairs left to `standard`: rays cast, rays of the rule
    std::size_t open_pairs_ = 0;
    std::uint64_t step_ = 1; ///< of `held_`

    Array<kernels::DirectedPair> pairs_; ///< of directed_
    Array<kernels::Segment> segments_;
    Array<kernels::CandidateTest> tests_;
    Array<kernels::HeldRange> held_ranges_; ///< of directed_
    Columns test_rays_;
    Array<kernels::DirectedPair> wide_pairs_; ///< by index of some stale pairs, like the next two
    Array<float> horizons_;
    Array<kernels::uint> places_;
    BlockSearch near_, standard_;
    Array<kernels::CandidateBlock> candidates_;
    Array<kernels::Held> held_, last_held_;
};

} // namespace raycontact
