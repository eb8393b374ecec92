// SPDX-License-Identifier: Apache-2.0
#include "schedule/assignment.h"

#include <algorithm>

namespace raycontact {

void Assignment::assign(std::span<const SlotPair> pairs, Balance& balance) {
    pairs_ = pairs;
    if (lists_.size() == 1) return;
    const bool same = std::ranges::equal(pairs, open_);
    if (same && !given_away_) return;
    if (!same) {
        next_parts_.resize(pairs.size());
        auto old = open_.begin();
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            while (old != open_.end() && *old < pairs[i]) ++old;
            const bool stays = old != open_.end() && *old == pairs[i];
            next_parts_[i] = stays ? parts_[static_cast<std::size_t>(old - open_.begin())]
                                   : static_cast<std::uint32_t>(balance.part_for_new_pair());
        }
        parts_.swap(next_parts_);
        open_.assign(pairs.begin(), pairs.end());
    }
    make_lists();
}

// One part alone needs no lists.
void Assignment::add_part() {
    if (lists_.size() == 1) {
        open_.assign(pairs_.begin(), pairs_.end());
        parts_.assign(pairs_.size(), 0);
    }
    lists_.emplace_back();
    make_lists();
}

void Assignment::make_lists() {
    given_away_ = true; // until the lists are whole
    for (auto& list : lists_) list.clear();
    for (std::size_t i = 0; i < open_.size(); ++i) lists_[parts_[i]].push_back(open_[i]);
    given_away_ = false;
}

std::span<const SlotPair> Assignment::pairs_of(std::size_t part) const {
    if (lists_.size() == 1) return pairs_;
    return lists_[part];
}

std::vector<std::vector<SlotPair>> Assignment::give_away(std::span<const std::size_t> from, Balance& balance) {
    std::vector<std::vector<SlotPair>> given(lists_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) {
        if (std::ranges::find(from, parts_[i]) == from.end()) continue;
        const std::size_t to = balance.part_for_new_pair();
        parts_[i] = static_cast<std::uint32_t>(to);
        given[to].push_back(open_[i]);
    }
    given_away_ = true;
    return given;
}

void Assignment::move(std::span<const SlotPair> moving, std::size_t to) {
    auto at = open_.begin();
    for (const SlotPair& pair : moving) {
        at = std::lower_bound(at, open_.end(), pair);
        parts_[static_cast<std::size_t>(at - open_.begin())] = static_cast<std::uint32_t>(to);
    }
}

} // namespace raycontact
