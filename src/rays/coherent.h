// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/displacement.h"
#include "pairs/pair_table.h"
#include "rays/block_search.h"
#include "rays/ray_batch.h"

#include <raycontact/scene.h>

#include <array>
#include <cstddef>

namespace raycontact {

/// A ray that the next step follows.
struct KeptRay {
    SlotPair pair;
    bool from_a = false;        ///< its vertex is one of the pair's first body
    std::uint32_t vertex = 0;   ///< of the source's shape
    std::uint32_t triangle = 0; ///< of the other shape, where the walk begins
};

/// The iterative method (LGA13; paper section 3) and, with predictions, the predictive one (paper section 3.1). A pair
/// that moved less than a threshold since its last full test follows the rays it kept; others get a full test. If the
/// library chooses the threshold of `predictive`, pairs too fast to be followed are cast in full. The host decides by
/// pairs, and reads what became of their rays at the end of the step.
class CoherentRays {
public:
    void begin(const Update& update, RayBatch& batch);
    /// Arguments of the read at the end of the step.
    std::array<Piece, 3> results();
    /// After it: false if blocks or rays had too little room: there is enough now, and cast() must run again.
    bool had_room(Device& device, RayBatch& batch);
    /// Casts and follows the rays again.
    void cast(const Update& update, RayBatch& batch);
    /// Then: stores what each pair follows in the next step.
    void keep(const RayBatch& batch);
    void clear() {
        table_.clear();
        cached_count_ = 0;
    }

    /// The state kept for some pairs of the last step, for another part to go on with. Between two steps.
    std::vector<std::byte> export_state(Device& device, const PairSlots& open, const PairList& pairs);
    /// Adds such state, before the step that first has these pairs: the same, in the slots that they have here.
    void import_state(Device& device, const PairList& pairs, std::span<const std::byte> bytes);

    /// Adds what is kept for the pairs of the last step that are still open; bodies as in it.
    void list_kept_rays(Device& device, std::span<const PlacedBody> bodies, const PairSlots& open,
                        std::vector<KeptRay>& rays);

    /// Adds what the last step did.
    void count(StepStats& stats) const;
    /// After a step: frees what the next makes anew.
    void trim();

private:
    enum class Turn : std::uint8_t { follow, test };
    void choose_turn(const Update& update, std::uint32_t i);
    void choose_turns(const Update& update);
    void list_segments();
    void find_rays(const Update& update, RayBatch& batch);
    void skip_apart();
    void follow(const Update& update, RayBatch& batch);
    void list_cached_rays(const Update& update, RayBatch& batch);
    /// The rays that one direction of a pair keeps: a range of cached_.
    struct Kept {
        std::uint32_t first = 0, count = 0;
    };
    struct PairState {
        PairPlace reference;      ///< where the bodies were when the pair was last tested in full
        double threshold = -1;    ///< metres, of that test; below 0: there was none
        double safe = 0;          ///< metres that the pair could move then before any contact, if it found no block
        double culling = 0;       ///< metres, length of predictive rays; below 0: too fast to be followed
        double test_cost = 0;     ///< what that test cost, in rays
        std::uint64_t tested = 0; ///< its step
    };
    struct Hot {
        double slack = -1; ///< metres that the pair may move, by a cheap bound, before the exact one is asked
        Kept kept[2];
    };
    struct Moving {         ///< a pair between two devices; its cached rays follow
        std::uint32_t pair; ///< its place among those that move
        PairState state;
        Hot hot;
    };
    std::vector<kernels::CachedRay> read_cached_rays(Device& device);
    static std::span<const kernels::CachedRay> cached_of(const Kept& own, std::span<const kernels::CachedRay> all);
    Kept& kept(std::uint32_t directed) { return table_.hot(directed / 2).kept[directed % 2]; }

    PairTable<PairState, Hot> table_;
    std::vector<Turn> turns_;             ///< per pair
    std::vector<std::uint32_t> directed_; ///< directed indices of the batch: full tests, then what is followed
    std::size_t full_count_ = 0;          ///< of directed_
    bool skips_outside_ = false;          ///< in the step
    std::vector<kernels::DirectedPair> host_pairs_, wide_pairs_;
    std::vector<float> cullings_, reaches_, margins_; ///< of directed_, of the full ones, of the full ones
    std::vector<kernels::Segment> host_segments_;
    std::vector<kernels::uint> host_firsts_, host_ranges_;
    std::vector<kernels::Followed> host_followed_;
    StepDetails sums_;
    std::uint64_t followed_count_ = 0; ///< rays
    std::uint64_t full_rays_ = 0, cached_count_ = 0, open_pairs_ = 0;
    std::uint64_t step_ = 0;

    Array<kernels::DirectedPair> device_pairs_, device_wide_;
    Array<float> device_cullings_, device_reaches_, device_margins_;
    Columns kept_counts_;
    Array<kernels::uint> segment_firsts_, ranges_, starts_, nexts_, hows_;
    BlockSearch near_;
    Array<kernels::Segment> segments_;
    Array<kernels::CachedRay> cached_, last_cached_; ///< last_cached_: of the step before
    Array<kernels::Followed> followed_;
};

} // namespace raycontact
