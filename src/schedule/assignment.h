// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"
#include "pairs/open_pairs.h"
#include "schedule/balance.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Which part each pair is on, but for those of round bodies, which no part answers. A pair stays where it is while it
/// is open (paper section 4), unless it is moved. Of several parts each numbers its own pairs.
class Assignment {
public:
    explicit Assignment(std::size_t parts) : parts_(parts) {}
    /// One more part, the last, without pairs. After an assign() of the same step.
    void add_part();

    /// pairs: of a step; valid until the next call. New pairs go where the load is least. has_rounds: some bodies are
    /// round.
    void assign(const OpenPairs& pairs, std::span<const PlacedBody> bodies, bool has_rounds, Balance& balance);
    /// What of a sorted list is on each part, for asked_of(). The list stays valid for the step.
    void ask(Executor& executor, const PairList& asked);

    const PairSlots& open_on(std::size_t part) const { return alone() ? pairs_->slots() : parts_[part].open; }
    /// In order, by the slots of the part.
    const PairList& asked_of(std::size_t part) const { return alone() ? *asked_ : parts_[part].asked; }
    /// Where the pair in a slot of the scene is; of one that no part answers the first.
    std::size_t part_of(std::uint32_t slot) const {
        return alone() || places_[slot].part == none ? 0 : places_[slot].part;
    }
    /// All that are on a part, in order, by its slots.
    PairList all_on(std::size_t part) const;

    /// Gives the pairs of some parts to the others, as if they were new. Returns who got which, by part, in order.
    std::vector<PairList> give_away(std::span<const std::size_t> from, Balance& balance);
    /// moving: of all_on(). They get the slots of the other part.
    void move(PairList& moving, std::size_t from, std::size_t to);

    /// Once all parts have begun the step: what comes after this is for the next one.
    void step_done() noexcept;
    /// All parts begin anew.
    void forget() noexcept;

private:
    static constexpr std::uint32_t none = NONE;
    struct Place {
        std::uint32_t part = none, slot = none;
    };
    struct Own {
        PairSlots open;
        std::vector<std::uint32_t> scene_slots; ///< by slot
        PairList asked;
    };
    /// One part has all pairs, by the slots of the scene.
    bool alone() const { return parts_.size() == 1 && !divided_; }
    void divide();
    void put(std::uint32_t slot, std::size_t part);
    void take(std::uint32_t slot) noexcept;

    const OpenPairs* pairs_ = nullptr;
    const PairList* asked_ = nullptr;
    std::vector<Own> parts_;
    bool divided_ = false;          ///< the parts have slots of their own
    std::vector<Place> places_;     ///< by slot of the scene
    std::vector<std::size_t> ends_; ///< of ask(): by part, then slice
    SlotChanges::Seen seen_ = 0;
};

} // namespace raycontact
