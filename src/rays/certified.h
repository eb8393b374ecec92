// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/staged.h"
#include "pairs/displacement.h"
#include "pairs/motion.h"
#include "pairs/pair_table.h"
#include "pairs/range_pool.h"
#include "rays/block_finder.h"
#include "rays/held.h"

#include <raycontact/scene.h>

#include <optional>

namespace raycontact {

/// The rays of a step by the certified method: those of `standard` that could be contacts, and hardly any other
/// (docs/certified.md). Each ordered pair watches the vertex blocks within some distance of its target; a block, and a
/// pair, sleeps until the pair has moved as far as the nearest vertex was from touching. Pairs too fast for that to pay
/// are left to `standard`.
class CertifiedRays {
public:
    /// threshold: metres that a list of blocks reaches beyond the bounds; empty: chosen by the pair's speed and size.
    void fill(Device& device, Executor& executor, const ShapeStore& shapes, std::span<const PlacedBody> bodies,
              std::span<const SlotPair> pairs, const Motion& motion, std::optional<double> threshold);
    void clear();

    const Array<kernels::OrderedPair>& pairs() const { return pairs_.array(); }
    const Array<kernels::Ray>& rays() const { return rays_; }
    /// What `standard` finds for these rays, most of them without being cast; basic: all of them cast. Once after each
    /// fill(): what that has found is kept here.
    void cast(Device& device, Executor& executor, Caster caster, const ShapeStore& shapes);
    const Array<kernels::Hit>& hits() const { return hits_; }
    /// 2 x pair + direction of each of pairs(), ascending.
    std::span<const std::uint32_t> ordered() const { return active_; }
    /// The same of the pairs that are none of ours in this step: every vertex of theirs is to be looked at.
    std::span<const std::uint32_t> fast() const { return fast_; }
    /// The same of the pairs of which neither body has moved: their contacts are those of the last step.
    std::span<const std::uint32_t> still() const { return still_; }
    /// Of the step before.
    std::span<const SlotPair> last_pairs() const { return table_.last_pairs(); }

    /// Adds what the last step did.
    void count(StepStats& stats) const;

private:
    /// One direction of a pair: its list of blocks, and its clock. All of it in metres of the clock, which runs from
    /// the pair's reference pose on.
    struct Watched {
        double clock = 0;   ///< at the reference pose
        double wake = 0;    ///< no watch need be looked at before the clock reaches this
        double expiry = -1; ///< a new list is due when the clock reaches this; below 0: at once
        std::uint32_t first = 0, count = 0, capacity = 0; ///< of watches_
    };
    /// The rays of one direction, of the last step; decided in each in which the pair moves.
    struct Cast {
        std::uint32_t first = 0, count = 0;
        bool held = false; ///< what was found out about them lies there, too
    };
    struct alignas(state_head) PairState {
        Cast rays[2]; ///< first: all that a pair is asked for that only repeats them
        Watched watched[2];
        double speed = 0; ///< metres a step, smoothed; decides how far a list reaches
        PairPlace reference;
    };
    static_assert(sizeof(PairState::rays) <= state_head);
    /// A direction that is due.
    struct Due {
        Watched* own = nullptr;
        Cast* rays = nullptr;
        /// The clock now, and that from which new wakes count: the reference is kept while a pair only trembles about
        /// it, and what is seen from beside it holds for that much less.
        float now = 0, from = 0;
        float margin = 0, radius = 0; ///< of rounding; of tubes
        kernels::uint asks_caps = 0;  ///< of its rays
        double longest = 0;           ///< metres that a new list may last
        double expiry = 0;            ///< of Watched, as what follows
        std::uint32_t first = 0, count = 0;
        Cast last;         ///< *rays, before this step
        bool look = false; ///< at its watches; else its rays are repeated
    };
    struct Found {
        double wake = 1e300; ///< the least of its watches
        std::uint32_t ray_first = 0, rays = 0;
        std::uint32_t blocks = 0; ///< looked at
    };
    /// What is due of some successive pairs, found by one thread; ordered, pairs: of due. stale: places in due of those
    /// that need a new list.
    struct Slice {
        Slice();
        void clear();

        std::vector<Due> due;
        std::vector<std::uint32_t> ordered;
        std::vector<kernels::OrderedPair> pairs;
        std::vector<std::uint32_t> stale, fast, still;
        std::size_t first = 0;                       ///< of due, in active_
        std::size_t segment_first = 0, segments = 0; ///< of theirs
        std::uint64_t blocks = 0;                    ///< looked at
    };
    struct Stale {
        Slice* slice;
        std::uint32_t at; ///< in due
        Due& due() const { return slice->due[at]; }
    };

    /// work(slice) for each slice of this step, `grain` of them at a time.
    template <class Work>
    void each_slice(Executor& executor, std::uint32_t grain, Work&& work);
    void wake_up(Executor& executor, std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                 const Motion& motion, std::optional<double> threshold);
    void wake_slice(std::uint32_t begin, std::uint32_t end, std::span<const PlacedBody> bodies,
                    std::span<const SlotPair> pairs, const Motion& motion, std::optional<double> threshold,
                    Slice& slice);
    void make_lists(Device& device, const ShapeStore& shapes);
    void look(Device& device, const ShapeStore& shapes);
    void wake_pair(std::uint32_t i, std::span<const PlacedBody> bodies, const SlotPair& pair, double shear,
                   double speed, std::optional<double> threshold, Slice& slice);
    void list_stale();
    void gather(Device& device, Executor& executor);
    void settle(Device& device, Executor& executor, bool held);
    static Found add_up(std::span<const kernels::Look> looks);
    void settle_one(std::uint32_t ordered, const Due& due, const Found& found, bool held, kernels::Holder& holder);
    void close(PairState& state);
    void repeat_pair(std::uint32_t i, std::span<const PlacedBody> bodies, const SlotPair& pair, double shear,
                     double speed, Slice& slice);
    Due& add_due(std::uint32_t ordered, const PlacedBody& source, const PlacedBody& target, double speed,
                 const PairPlace& now, Slice& slice);
    static void forget_rays(PairState& state);

    struct Slack {
        double metres = -1; ///< that the pair may move, by a cheap bound, before the exact one is asked
        bool lists = false; ///< there is something to be given back
        bool still = false; ///< it did not move in the last step, which kept no rays of it
        bool casts = false; ///< it has rays, to be decided in each step in which it moves
    };

    PairTable<PairState, Slack> table_;
    RangePool pool_;
    Scan scan_;
    std::vector<Slice> slices_;     ///< only ever more
    std::uint32_t slice_count_ = 0; ///< of this step
    std::vector<Stale> stale_;
    std::vector<std::uint32_t> active_, fast_, still_; ///< ordered pairs
    std::vector<float> host_clears_;                   ///< of stale_
    std::vector<kernels::uint> host_counts_;
    std::uint64_t open_pairs_ = 0, cast_ = 0, packed_ = 0;

    Staged<kernels::OrderedPair> pairs_;
    Staged<kernels::Segment> segments_;
    Staged<kernels::Look> looks_;
    Staged<kernels::uint> firsts_;
    Staged<kernels::Holder> holders_;
    Staged<kernels::OrderedPair> wide_pairs_; ///< of stale_, as what follows
    Staged<float> margins_, horizons_;
    Staged<kernels::uint> places_;
    Array<kernels::uint> counts_;
    BlockFinder finder_;
    Array<kernels::Watch> watches_;
    Array<kernels::Ray> rays_, last_rays_;
    HeldRays held_;
    Array<kernels::Hit> hits_;
};

} // namespace raycontact
