// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "free_all.h"
#include "pairs/pair_slots.h"
#include "platform/prefetch.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What a method keeps for each open pair, by slot. Hot is the part that is read for every pair that is asked about;
/// State is the rest.
template <class State, class Hot>
class PairTable {
public:
    /// Once a step. What opened since the last begin() gets a fresh state; calls closed(state) for each that is gone.
    /// asked: slots of open pairs.
    template <class Closed>
    void begin(const PairSlots& open, std::span<const std::uint32_t> asked, Closed&& closed) {
        const bool all = open.changes().each_since(seen_, states_.size(), [&](std::uint32_t slot) {
            closed(states_[slot]);
            states_[slot] = {};
            hot_[slot] = {};
        });
        if (all) free_all(states_, hot_);
        states_.resize(open.end());
        hot_.resize(open.end());
        for (const Incoming& one : incoming_) {
            if (one.slot >= open.end() || open[one.slot] != one.pair) continue; // closed again
            states_[one.slot] = one.state;
            hot_[one.slot] = one.hot;
        }
        incoming_.clear();
        asked_ = asked;
        open_ = open.count();
    }
    /// Whether the next begin() will know what changed since the last one; else every pair begins afresh.
    bool knows(const PairSlots& open) const { return open.changes().is_next(seen_); }
    /// Whether it has something of the pair that is open in this slot.
    bool knows(const PairSlots& open, std::uint32_t slot) const {
        return knows(open) && slot < states_.size() && open.is_open(slot) && !open.changes().is_marked(slot);
    }

    /// Hands over what another table kept for a pair that the next begin() opens.
    void import_state(const SlotPair& pair, std::uint32_t slot, const State& state, const Hot& hot) {
        incoming_.push_back({pair, slot, state, hot});
    }

    /// Of the i-th pair that is asked about.
    State& state(std::size_t i) { return states_[asked_[i]]; }
    Hot& hot(std::size_t i) { return hot_[asked_[i]]; }
    /// Of the last begin(); what knows() says that it has.
    const State& state_in(std::uint32_t slot) const { return states_[slot]; }
    const Hot& hot_in(std::uint32_t slot) const { return hot_[slot]; }

    /// Calls ask(i) for each pair of [begin, end) for which wants(i, hot) is true. Works in batches and prefetches the
    /// states of a batch before the first ask(), since a solver has used the caches between two steps. Calls
    /// prefetch(i) some pairs ahead, for what wants() reads besides hot.
    template <class Prefetch, class Wants, class Ask>
    void sift(std::uint32_t begin, std::uint32_t end, Prefetch&& prefetch, Wants&& wants, Ask&& ask) {
        constexpr std::uint32_t handful = 32, ahead = 8;
        std::uint32_t due[handful];
        const auto send_for = [&](std::uint32_t i) {
            if (i >= end) return;
            platform::prefetch(&hot(i));
            prefetch(i);
        };
        for (std::uint32_t i = begin; i < begin + ahead; ++i) send_for(i);
        for (std::uint32_t first = begin; first < end; first += handful) {
            std::uint32_t count = 0;
            for (std::uint32_t i = first; i < std::min(first + handful, end); ++i) {
                send_for(i + ahead);
                if (!wants(i, hot(i))) continue;
                prefetch_state(i);
                due[count++] = i;
            }
            for (std::uint32_t k = 0; k < count; ++k) ask(due[k]);
        }
    }

    /// Forgets every pair.
    void clear() { *this = {}; }

    std::uint64_t bytes() const { return open_ * (sizeof(Hot) + sizeof(State)); }

private:
    void prefetch_state(std::size_t i) const {
        constexpr std::size_t line = 64;
        const char* bytes = reinterpret_cast<const char*>(&states_[asked_[i]]);
        for (std::size_t at = 0; at < sizeof(State); at += line) platform::prefetch(bytes + at);
    }

    struct Incoming {
        SlotPair pair;
        std::uint32_t slot;
        State state;
        Hot hot;
    };

    std::vector<State> states_; ///< by slot
    std::vector<Hot> hot_;
    std::vector<Incoming> incoming_;
    std::span<const std::uint32_t> asked_;
    std::size_t open_ = 0;
    SlotChanges::Seen seen_ = 0;
};

} // namespace raycontact
