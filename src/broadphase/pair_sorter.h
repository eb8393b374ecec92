// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "slot_pair.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Sorts pairs by counting those of each first body, then each body's by the second.
class PairSorter {
public:
    /// lists: of pairs of bodies below `slots`, in any order. sorted: becomes all of them.
    void run(Executor& executor, std::size_t slots, std::span<const std::span<const SlotPair>> lists,
             std::vector<SlotPair>& sorted);
    /// The same of one list.
    void run(Executor& executor, std::size_t slots, std::span<const SlotPair> pairs, std::vector<SlotPair>& sorted);

private:
    std::vector<std::span<const SlotPair>> pieces_;
    std::vector<std::size_t> ends_; ///< by slot, and one more
};

} // namespace raycontact
