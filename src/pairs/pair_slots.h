// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "free_all.h"
#include "slot_pair.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace raycontact {

/// Whether so many of `slots` are in use that those who number by them should begin anew.
inline bool is_mostly_empty(std::size_t slots, std::size_t used) {
    return slots > 4 * used + 1024;
}

/// The open pairs. Each keeps its slot while it is open. Slots are reused, so memory follows the most pairs ever open
/// at once.
class PairSlots {
public:
    /// pairs: sorted, without duplicates. Calls, in their order, kept(old, now, n) for n pairs in a row that stay,
    /// opened(now, slot) for each new pair and closed(slot) for each that is gone; old and now are places in the last
    /// list and in `pairs`. Returns false, without any call, if the pairs are the same as before.
    template <class Kept, class Opened, class Closed>
    bool match(std::span<const SlotPair> pairs, Kept&& kept, Opened&& opened, Closed&& closed) {
        if (std::equal(pairs.begin(), pairs.end(), open_.begin(), open_.end())) return false;
        next_.resize(pairs.size());
        std::size_t old = 0;
        const auto close = [&] {
            closed(slots_[old]);
            free_.push_back(slots_[old++]);
        };
        for (std::size_t i = 0; i < pairs.size();) {
            // Most pairs stay, in runs.
            const std::size_t most = std::min(pairs.size() - i, open_.size() - old);
            std::size_t same = 0;
            while (same < most && pairs[i + same] == open_[old + same]) ++same;
            std::copy_n(slots_.begin() + std::ptrdiff_t(old), same, next_.begin() + std::ptrdiff_t(i));
            if (same > 0) kept(old, i, same);
            i += same;
            old += same;
            if (i == pairs.size()) break;
            if (old < open_.size() && open_[old] < pairs[i]) {
                close();
                continue;
            }
            next_[i] = new_slot();
            opened(i, next_[i]);
            ++i;
        }
        while (old < open_.size()) close();
        slots_.swap(next_);
        open_.assign(pairs.begin(), pairs.end());
        return true;
    }

    std::span<const SlotPair> pairs() const { return open_; }
    /// The slot of the i-th pair.
    std::uint32_t slot(std::size_t i) const { return slots_[i]; }
    /// All slots are below this.
    std::uint32_t end() const { return end_; }

    /// Gives the open pairs the lowest slots, and memory back. Calls moved(slot, i) for the i-th pair, which has slot i
    /// from then on.
    template <class Moved>
    void compact(Moved&& moved) {
        for (std::size_t i = 0; i < slots_.size(); ++i) {
            moved(slots_[i], i);
            slots_[i] = static_cast<std::uint32_t>(i);
        }
        end_ = static_cast<std::uint32_t>(slots_.size());
        free_all(next_);
        free_all(free_);
        open_.shrink_to_fit();
        slots_.shrink_to_fit();
    }

    void clear() { *this = {}; }

private:
    std::uint32_t new_slot() {
        if (free_.empty()) return end_++;
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        return slot;
    }

    std::vector<SlotPair> open_;
    std::vector<std::uint32_t> slots_, next_, free_;
    std::uint32_t end_ = 0;
};

} // namespace raycontact
