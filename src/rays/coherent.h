// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/displacement.h"
#include "pairs/motion.h"
#include "pairs/pair_table.h"
#include "rays/block_finder.h"

#include <raycontact/scene.h>

#include <array>

namespace raycontact {

/// The iterative method (LGA13; paper section 3) and, with predictions, the predictive one (paper section 3.1). A pair
/// that moved less than a threshold since it was last looked at in full follows the rays it kept; others cast anew.
/// Where the threshold of `predictive` is left to the library, pairs too fast to be followed are left to others.
class CoherentRays {
public:
    void follow(Device& device, Executor& executor, const ShapeStore& shapes, std::span<const PlacedBody> bodies,
                std::span<const SlotPair> pairs, const Motion& motion, const Settings& settings);
    void clear() { table_.clear(); }

    const Array<kernels::OrderedPair>& pairs() const { return device_pairs_; }
    const Array<kernels::Ray>& rays() const { return rays_; }
    const Array<kernels::Hit>& hits() const { return hits_; }
    /// 2 x pair + direction of each of pairs(): first those looked at in full, then those followed, each ascending.
    std::span<const std::uint32_t> ordered() const { return active_; }
    /// Of the pairs of the last step those that are none of ours in it, ascending.
    std::span<const std::uint32_t> fast() const { return fast_; }
    /// Adds what the last step did.
    void count(StepStats& stats) const;

private:
    enum class Turn : std::uint8_t { follow, look, leave };
    void wake_pair(std::uint32_t i, std::span<const PlacedBody> bodies, const SlotPair& pair, const Motion& motion,
                   const Settings& settings);
    void wake_up(Executor& executor, std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                 const Motion& motion, const Settings& settings);
    void find_rays(Device& device, const ShapeStore::Arrays& arrays);
    void let_sleep(Device& device);
    void cast(Device& device, const ShapeStore::Arrays& arrays, const Settings& settings);
    void keep(Device& device);
    /// The rays that one direction of a pair keeps: a range of candidates_.
    struct Kept {
        std::uint32_t first = 0, count = 0;
    };
    struct PairState {
        PairPlace reference;      ///< where the bodies were when the pair was last looked at in full
        double threshold = -1;    ///< metres, of that look; below 0: there was none
        double clear = 0;         ///< metres that it saw the pair to be away from any contact, where it found nothing
        double culling = 0;       ///< metres a predictive ray looks ahead
        double look_cost = 0;     ///< what that look cost, in rays
        std::uint64_t looked = 0; ///< its step
    };
    struct Hot {
        double slack = -1; ///< metres that the pair may move, by a cheap bound, before the exact one is asked
        Kept kept[2];
    };
    static double next_threshold(const PlacedBody& a, const PlacedBody& b, const PairState& state, double speed,
                                 double follows, bool predictive);
    static bool is_too_fast(const PlacedBody& a, const PlacedBody& b, double speed);
    Kept& kept(std::uint32_t ordered) { return table_.hot(ordered / 2).kept[ordered % 2]; }

    PairTable<PairState, Hot> table_;
    Scan scan_;
    std::vector<Turn> turns_;           ///< per pair
    std::vector<std::uint32_t> active_; ///< ordered pairs
    std::vector<std::uint32_t> fast_;   ///< pairs
    std::size_t full_count_ = 0;        ///< of active_
    std::vector<kernels::OrderedPair> host_pairs_, wide_pairs_;
    std::vector<float> cullings_, reaches_, margins_; ///< of active_, of the full ones, of the full ones
    std::vector<float> host_clears_;                  ///< of the full ones
    std::vector<kernels::uint> host_counts_;
    std::vector<kernels::Segment> host_segments_;
    std::vector<kernels::uint> host_firsts_, host_ranges_;
    std::vector<kernels::Followed> host_followed_;
    StepStats sums_;
    std::uint64_t full_rays_ = 0, candidates_kept_ = 0, open_pairs_ = 0;
    std::uint64_t packed_ = 0, step_ = 0;

    Array<kernels::OrderedPair> device_pairs_, device_wide_;
    Array<float> device_cullings_, device_reaches_, device_margins_;
    Array<kernels::uint> counts_, inside_, firsts_, segment_firsts_, ranges_, starts_, nexts_, hows_;
    BlockFinder finder_;
    Array<kernels::Segment> segments_;
    Array<kernels::Candidate> candidates_;
    Array<kernels::Ray> rays_;
    Array<kernels::Hit> hits_;
    Array<kernels::Followed> followed_;
};

} // namespace raycontact
