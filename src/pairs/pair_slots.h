// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "slot_changes.h"
#include "slot_pair.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// The open pairs. Each keeps its slot while it is open. Slots are reused, so memory follows the most pairs ever open
/// at once.
class PairSlots {
public:
    /// Of a new pair.
    std::uint32_t open(const SlotPair& pair) {
        if (free_ == NONE) {
            changes_.make_room(bodies_.size() + 1);
            bodies_.push_back({NONE, NONE});
            free_ = end() - 1;
        }
        const std::uint32_t slot = free_;
        free_ = bodies_[slot].second;
        bodies_[slot] = {pair.first, pair.second};
        ++count_;
        changes_.mark(slot);
        return slot;
    }
    void close(std::uint32_t slot) noexcept {
        bodies_[slot] = {NONE, std::exchange(free_, slot)};
        --count_;
        changes_.mark(slot);
    }
    /// Closes all, and frees their memory.
    void clear() noexcept {
        bodies_ = {};
        free_ = NONE;
        count_ = 0;
        changes_.cut(0);
    }

    bool is_open(std::uint32_t slot) const { return bodies_[slot].first != NONE; }
    SlotPair operator[](std::uint32_t slot) const { return {bodies_[slot].first, bodies_[slot].second}; }
    /// By slot; first NONE where no pair is open.
    std::span<const kernels::PairBodies> bodies() const { return bodies_; }
    /// All slots are below this.
    std::uint32_t end() const { return static_cast<std::uint32_t>(bodies_.size()); }
    std::size_t count() const { return count_; }
    /// Whether so few slots are in use that all should begin anew.
    bool is_mostly_empty() const { return bodies_.size() > 4 * count() + 1024; }

    /// The slots that were opened or closed since the last step.
    const SlotChanges& changes() const { return changes_; }
    void step_done() noexcept { changes_.step_done(); }
    /// Any pair may be another.
    void forget() noexcept { changes_.forget(); }

private:
    std::vector<kernels::PairBodies> bodies_; ///< by slot; of an empty one, second: the next empty one
    std::uint32_t free_ = NONE;               ///< the first empty slot
    std::size_t count_ = 0;
    SlotChanges changes_;
};

} // namespace raycontact
