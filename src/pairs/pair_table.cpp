// SPDX-License-Identifier: Apache-2.0
#include "pairs/pair_table.h"

namespace raycontact {

std::uint32_t PairTable::take_slot() {
    if (free_.empty()) {
        states_.emplace_back();
        slacks_.push_back(-1);
        return static_cast<std::uint32_t>(states_.size() - 1);
    }
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    states_[slot] = PairState{};
    slacks_[slot] = -1;
    return slot;
}

void PairTable::clear() {
    open_.clear();
    slots_.clear();
    free_.clear();
    states_.clear();
    slacks_.clear();
}

std::uint64_t PairTable::bytes() const {
    return open_.size() * (sizeof(Pair) + sizeof(std::uint32_t))
           + (states_.size() - free_.size()) * (sizeof(PairState) + sizeof(double));
}

} // namespace raycontact
