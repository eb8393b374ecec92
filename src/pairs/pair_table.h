// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/displacement.h"

#include <raycontact/scene.h>

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What a method keeps for one direction of a pair: a range of its own array, and the pair's clock.
struct DirectedState {
    double clock = 0;        ///< metres moved at most since the last full look, up to the reference pose
    double wake = 0;         ///< nothing need be looked at before the clock reaches this
    double expiry = -1;      ///< a full look is due when the clock reaches this; below 0: at once
    std::uint32_t first = 0; ///< of what the method keeps
    std::uint32_t count = 0;
    std::uint32_t capacity = 0;
};

/// What lives from step to step for a pair: where its bodies were when either direction was last looked at, and both
/// directions.
struct PairState {
    PairPlace reference;
    double speed = 0;         ///< metres a step, smoothed; decides how far a full look looks ahead
    double culling = 0;       ///< metres a predictive ray looks ahead
    double threshold = 0;     ///< metres, of the last full look
    double look_cost = 0;     ///< what that look cost, in rays
    double steps = 0;         ///< how many steps lay before it
    std::uint64_t looked = 0; ///< its step
    DirectedState directed[2];
};

/// The pairs that were open in the last step, each with its state; others have none. Slots are reused, so memory is
/// proportional to the most pairs ever open at once.
class PairTable {
public:
    /// pairs: sorted, each once. Opens the new ones with a fresh state; closed(state) is told of those that are gone.
    template <class Closed>
    void match(std::span<const Pair> pairs, Closed&& closed) {
        next_slots_.clear();
        std::size_t old = 0;
        for (const Pair& pair : pairs) {
            while (old < open_.size() && open_[old] < pair) close(old++, closed);
            if (old < open_.size() && open_[old] == pair)
                next_slots_.push_back(slots_[old++]);
            else
                next_slots_.push_back(take_slot());
        }
        while (old < open_.size()) close(old++, closed);
        slots_.swap(next_slots_);
        open_.assign(pairs.begin(), pairs.end());
    }

    /// Of the i-th pair of the last match.
    PairState& state(std::size_t i) { return states_[slots_[i]]; }
    /// How far that pair may move, by a cheap bound, before the exact one is asked; below 0 for a new pair. Kept apart:
    /// of most pairs nothing else is read in a step.
    double& slack(std::size_t i) { return slacks_[slots_[i]]; }

    /// Forgets every pair.
    void clear();
    std::uint64_t bytes() const;

private:
    template <class Closed>
    void close(std::size_t old, Closed& closed) {
        closed(states_[slots_[old]]);
        free_.push_back(slots_[old]);
    }
    std::uint32_t take_slot();

    std::vector<Pair> open_;
    std::vector<std::uint32_t> slots_, next_slots_, free_;
    std::vector<PairState> states_;
    std::vector<double> slacks_;
};

} // namespace raycontact
