// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "free_all.h"
#include "pairs/pair_slots.h"
#include "platform/prefetch.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// The pairs that were open in the last step, each with what a method keeps for it. Hot is the part that is read for
/// every pair in every step; it is stored in the order of the pairs. State is the rest, stored by slot.
template <class State, class Hot>
class PairTable {
public:
    /// pairs: sorted, without duplicates. New pairs get a fresh state; calls closed(state) for each that is gone.
    template <class Closed>
    void match(Executor& executor, std::span<const SlotPair> pairs, Closed&& closed) {
        next_hot_.resize(pairs.size());
        std::ranges::sort(incoming_, {}, &Incoming::pair);
        const auto keep = [this](std::size_t old, std::size_t now, std::size_t count) {
            std::copy_n(hot_.begin() + std::ptrdiff_t(old), count, next_hot_.begin() + std::ptrdiff_t(now));
        };
        const auto open = [this, pairs](std::size_t now, std::uint32_t slot) {
            if (slot == states_.size()) states_.emplace_back();
            const auto moved = std::ranges::lower_bound(incoming_, pairs[now], {}, &Incoming::pair);
            const bool fresh = moved == incoming_.end() || moved->pair != pairs[now];
            states_[slot] = fresh ? State{} : moved->state;
            next_hot_[now] = fresh ? Hot{} : moved->hot;
        };
        const bool changed =
            slots_.match(executor, pairs, keep, open, [&](std::uint32_t slot) { closed(states_[slot]); });
        if (changed) hot_.swap(next_hot_);
        incoming_.clear();
        if (is_mostly_empty(slots_.end(), pairs.size())) compact();
    }

    /// The place of a pair in the last match; empty if it was not open.
    std::optional<std::size_t> place(const SlotPair& pair) const {
        const std::span<const SlotPair> open = slots_.pairs();
        const auto at = std::lower_bound(open.begin(), open.end(), pair);
        if (at == open.end() || *at != pair) return std::nullopt;
        return static_cast<std::size_t>(at - open.begin());
    }
    /// Hands over what another table kept for a pair that the next match opens.
    void import_state(const SlotPair& pair, const State& state, const Hot& hot) {
        incoming_.push_back({pair, state, hot});
    }

    /// Of the i-th pair of the last match.
    State& state(std::size_t i) { return states_[slots_.slot(i)]; }
    Hot& hot(std::size_t i) { return hot_[i]; }

    /// Calls ask(i) for each pair of [begin, end) for which wants(i, hot) is true. Works in batches and prefetches the
    /// states of a batch before the first ask(), since a solver has used the caches between two steps. Calls
    /// prefetch(i) some pairs ahead, for what wants() reads besides hot.
    template <class Prefetch, class Wants, class Ask>
    void sift(std::uint32_t begin, std::uint32_t end, Prefetch&& prefetch, Wants&& wants, Ask&& ask) {
        constexpr std::uint32_t handful = 32, ahead = 8;
        std::uint32_t due[handful];
        const auto send_for = [&](std::uint32_t i) {
            if (i < end) prefetch(i);
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

    /// All pairs have had slots below this.
    std::uint32_t slots() const { return slots_.end(); }
    std::uint64_t bytes() const {
        return slots_.pairs().size() * (sizeof(SlotPair) + 2 * sizeof(std::uint32_t) + 2 * sizeof(Hot) + sizeof(State));
    }

private:
    void compact() {
        std::vector<State> states(slots_.pairs().size());
        slots_.compact([&](std::uint32_t slot, std::size_t i) { states[i] = states_[slot]; });
        states_.swap(states);
        hot_.shrink_to_fit();
        free_all(next_hot_);
        free_all(incoming_);
    }

    void prefetch_state(std::size_t i) const {
        constexpr std::size_t line = 64;
        const char* bytes = reinterpret_cast<const char*>(&states_[slots_.slot(i)]);
        for (std::size_t at = 0; at < sizeof(State); at += line) platform::prefetch(bytes + at);
    }

    struct Incoming {
        SlotPair pair;
        State state;
        Hot hot;
    };

    PairSlots slots_;
    std::vector<Incoming> incoming_;
    std::vector<State> states_;       ///< by slot
    std::vector<Hot> hot_, next_hot_; ///< by place; next_hot_ is a buffer for match()
};

} // namespace raycontact
