// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "schedule/balance.h"
#include "slot_pair.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Which part each pair is on. A pair stays where it is while it is open (paper section 4), unless it is moved.
class Assignment {
public:
    explicit Assignment(std::size_t parts) : lists_(parts) {}
    /// One more part, the last, without pairs. After an assign() of the same step.
    void add_part();

    /// pairs: of a step, sorted, each once; valid until the next call. New pairs go where the load is least.
    void assign(std::span<const SlotPair> pairs, Balance& balance);
    /// Those of a part, in the same order, as the last make_lists() found them.
    std::span<const SlotPair> pairs_of(std::size_t part) const;
    /// The part of pairs[i].
    std::size_t part_of(std::size_t i) const { return lists_.size() == 1 ? 0 : parts_[i]; }

    /// Gives the pairs of some parts to the others, as if they were new. Returns who got which, by part, sorted.
    std::vector<std::vector<SlotPair>> give_away(std::span<const std::size_t> from, Balance& balance);
    /// moving: of the last assign(), sorted.
    void move(std::span<const SlotPair> moving, std::size_t to);
    /// After give_away() or move(), unless an assign() follows.
    void make_lists();

private:
    std::span<const SlotPair> pairs_;
    std::vector<SlotPair> open_; ///< a copy of pairs_
    std::vector<std::uint32_t> parts_, next_parts_;
    std::vector<std::vector<SlotPair>> lists_;
    bool given_away_ = false; ///< since lists_ were made
};

} // namespace raycontact
