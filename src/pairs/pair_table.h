// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slot_pair.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What a step asks of a pair's state: its first state_head bytes, a cache line, or all of it.
enum class Wanted : std::uint8_t { nothing, head, all };
constexpr std::size_t state_head = 64;

/// The pairs that were open in the last step, each with its state; others have none. Slots are reused, so memory is
/// proportional to the most pairs ever open at once. State is what a method keeps for a pair; Hot what it reads of
/// every pair in every step, and lies in their order.
template <class State, class Hot>
class PairTable {
public:
    /// pairs: sorted, each once. Opens the new ones with a fresh state; closed(state) is told of those that are gone.
    template <class Closed>
    void match(std::span<const SlotPair> pairs, Closed&& closed) {
        same_ = std::equal(pairs.begin(), pairs.end(), open_.begin(), open_.end());
        if (same_) return;
        next_slots_.resize(pairs.size());
        next_hot_.resize(pairs.size());
        std::size_t old = 0;
        for (std::size_t i = 0; i < pairs.size();) {
            // Most pairs stay, in runs.
            const std::size_t most = std::min(pairs.size() - i, open_.size() - old);
            std::size_t same = 0;
            while (same < most && pairs[i + same].first == open_[old + same].first
                   && pairs[i + same].second == open_[old + same].second)
                ++same;
            std::copy_n(slots_.begin() + std::ptrdiff_t(old), same, next_slots_.begin() + std::ptrdiff_t(i));
            std::copy_n(hot_.begin() + std::ptrdiff_t(old), same, next_hot_.begin() + std::ptrdiff_t(i));
            i += same;
            old += same;
            if (i == pairs.size()) break;
            if (old < open_.size() && open_[old] < pairs[i]) {
                close(old++, closed);
                continue;
            }
            next_slots_[i] = take_slot();
            next_hot_[i++] = Hot{};
        }
        while (old < open_.size()) close(old++, closed);
        slots_.swap(next_slots_);
        hot_.swap(next_hot_);
        last_.swap(open_);
        open_.assign(pairs.begin(), pairs.end());
    }

    /// Of the match before the last, unless all has been forgotten since.
    std::span<const SlotPair> last_pairs() const { return same_ ? open_ : last_; }

    /// Of the i-th pair of the last match.
    State& state(std::size_t i) { return states_[slots_[i]]; }
    Hot& hot(std::size_t i) { return hot_[i]; }

    /// ask(i, wanted) for each pair of [begin, end) of which wants(i, hot), a Wanted, is not `nothing`. By handfuls, so
    /// that the states of some are on their way while others are asked: between two steps a solver has used the caches.
    /// prefetch(i), ahead of both: what wants() reads beside hot.
    template <class Prefetch, class Wants, class Ask>
    void sift(std::uint32_t begin, std::uint32_t end, Prefetch&& prefetch, Wants&& wants, Ask&& ask) {
        constexpr std::uint32_t handful = 32, ahead = 8;
        std::uint32_t awake[handful];
        Wanted wanted[handful];
        const auto send_for = [&](std::uint32_t i) {
            if (i < end) prefetch(i);
        };
        for (std::uint32_t i = begin; i < begin + ahead; ++i) send_for(i);
        for (std::uint32_t first = begin; first < end; first += handful) {
            std::uint32_t count = 0;
            for (std::uint32_t i = first; i < std::min(first + handful, end); ++i) {
                send_for(i + ahead);
                wanted[count] = wants(i, hot(i));
                if (wanted[count] == Wanted::nothing) continue;
                prefetch_state(i, wanted[count] == Wanted::head ? state_head : sizeof(State));
                awake[count++] = i;
            }
            for (std::uint32_t k = 0; k < count; ++k) ask(awake[k], wanted[k]);
        }
    }

    /// Forgets every pair.
    void clear() {
        open_.clear();
        last_.clear();
        same_ = false;
        slots_.clear();
        free_.clear();
        states_.clear();
        hot_.clear();
    }

    std::uint64_t bytes() const {
        return open_.size() * (sizeof(SlotPair) + sizeof(std::uint32_t) + sizeof(Hot))
               + (states_.size() - free_.size()) * sizeof(State);
    }

private:
    void prefetch_state(std::size_t i, std::size_t size) const {
        const char* bytes = reinterpret_cast<const char*>(&states_[slots_[i]]);
        for (std::size_t at = 0; at < size; at += state_head) __builtin_prefetch(bytes + at);
    }

    template <class Closed>
    void close(std::size_t old, Closed& closed) {
        closed(states_[slots_[old]]);
        free_.push_back(slots_[old]);
    }

    std::uint32_t take_slot() {
        if (free_.empty()) {
            states_.emplace_back();
            return static_cast<std::uint32_t>(states_.size() - 1);
        }
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        states_[slot] = State{};
        return slot;
    }

    std::vector<SlotPair> open_, last_;
    bool same_ = false; ///< the last match had the pairs of the one before: last_ is older
    std::vector<std::uint32_t> slots_, next_slots_, free_;
    std::vector<State> states_;
    std::vector<Hot> hot_, next_hot_; ///< by pair; the other one is only ever a buffer
};

} // namespace raycontact
