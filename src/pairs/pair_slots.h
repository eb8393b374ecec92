// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "slot_changes.h"
#include "slot_pair.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// The open pairs. Each keeps its slot while it is open. Slots are reused, so memory follows the most pairs ever open
/// at once.
class PairSlots {
public:
    PairSlots() = default;
    PairSlots(PairSlots&&) noexcept = default;
    PairSlots& operator=(PairSlots&&) noexcept = default;
    /// With the room that close() needs.
    PairSlots(const PairSlots& other) : bodies_(other.bodies_), changes_(other.changes_) {
        free_.reserve(bodies_.size());
        free_.assign(other.free_.begin(), other.free_.end());
    }
    PairSlots& operator=(const PairSlots& other) { return *this = PairSlots(other); }
    ~PairSlots() = default;

    /// Of a new pair.
    std::uint32_t open(const SlotPair& pair) {
        if (free_.empty()) {
            if (bodies_.size() == bodies_.capacity()) bodies_.reserve(2 * bodies_.size() + 64);
            free_.reserve(bodies_.capacity()); // so that close() cannot fail
            changes_.make_room(bodies_.capacity());
            bodies_.push_back(no_pair);
            free_.push_back(end() - 1);
        }
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        bodies_[slot] = {pair.first, pair.second};
        changes_.mark(slot);
        return slot;
    }
    void close(std::uint32_t slot) noexcept {
        bodies_[slot] = no_pair;
        free_.push_back(slot);
        changes_.mark(slot);
    }
    /// Closes all, and frees their memory.
    void clear() noexcept {
        bodies_ = {};
        free_ = {};
        changes_.cut(0);
    }

    bool is_open(std::uint32_t slot) const { return bodies_[slot].first != NONE; }
    SlotPair operator[](std::uint32_t slot) const { return {bodies_[slot].first, bodies_[slot].second}; }
    /// By slot; NONE where no pair is open.
    std::span<const kernels::PairBodies> bodies() const { return bodies_; }
    /// All slots are below this.
    std::uint32_t end() const { return static_cast<std::uint32_t>(bodies_.size()); }
    std::size_t count() const { return bodies_.size() - free_.size(); }
    /// Whether so few slots are in use that all should begin anew.
    bool is_mostly_empty() const { return bodies_.size() > 4 * count() + 1024; }

    /// The slots that were opened or closed since the last step.
    const SlotChanges& changes() const { return changes_; }
    void step_done() noexcept { changes_.step_done(); }
    /// Any pair may be another.
    void forget() noexcept { changes_.forget(); }

private:
    static constexpr kernels::PairBodies no_pair{NONE, NONE};

    std::vector<kernels::PairBodies> bodies_; ///< by slot
    std::vector<std::uint32_t> free_;
    SlotChanges changes_;
};

/// Pairs in order, and their slots.
struct PairList {
    std::vector<SlotPair> pairs;
    std::vector<std::uint32_t> slots;

    std::size_t size() const { return pairs.size(); }
    void add(const SlotPair& pair, std::uint32_t slot) {
        pairs.push_back(pair);
        slots.push_back(slot);
    }
    /// Those that are in a sorted list, too.
    void keep_only(std::span<const SlotPair> wanted) {
        std::size_t kept = 0;
        auto at = wanted.begin();
        for (std::size_t i = 0; i < size(); ++i) {
            while (at != wanted.end() && *at < pairs[i]) ++at;
            if (at == wanted.end() || *at != pairs[i]) continue;
            pairs[kept] = pairs[i];
            slots[kept++] = slots[i];
        }
        resize(kept);
    }
    void resize(std::size_t size) {
        pairs.resize(size);
        slots.resize(size);
    }
};

} // namespace raycontact
