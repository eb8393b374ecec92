// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slot_pair.h"

#include <span>

namespace raycontact {

/// Which part a pair is on. There is one part so far, and it has them all.
class Schedule {
public:
    /// pairs: of a step, sorted, each once; valid until the next call.
    void assign(std::span<const SlotPair> pairs) { pairs_ = pairs; }
    /// Those of a part, in the same order.
    std::span<const SlotPair> pairs_of(std::size_t) const { return pairs_; }

private:
    std::span<const SlotPair> pairs_;
};

} // namespace raycontact
