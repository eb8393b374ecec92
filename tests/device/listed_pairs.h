// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/open_pairs.h"
#include "part/part.h"

namespace raycontact::device_test {

/// The pairs of a part, as lists of them, one a step.
class ListedPairs {
public:
    /// For the next step, which asks about all.
    Part::Pairs next(std::span<const SlotPair> listed) {
        open_.set_all(executor_, listed);
        const PairList& all = open_.all(executor_);
        return {open_.slots(), all.pairs, all.slots};
    }
    /// Once the part has ended it.
    void step_done() { open_.step_done(); }
    /// Some that are open, in order, with their slots.
    PairList of(std::span<const SlotPair> pairs) {
        PairList list = open_.all(executor_);
        list.keep_only(pairs);
        return list;
    }

private:
    Executor executor_{1};
    OpenPairs open_;
};

} // namespace raycontact::device_test
