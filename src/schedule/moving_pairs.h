// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/pair_list.h"

#include <raycontact/contact.h>

#include <span>
#include <vector>

namespace raycontact {

/// The pairs that should leave a part, in order.
struct MovingPairs {
    PairList pairs;
    double share = 0; ///< of the part's load
};

/// Chooses about the given share of a part's load: all pairs of one body, then of the next, first those with the least
/// state to be moved. pairs: the part's, in order. contacts: of the last step, sorted; what a pair costs and keeps is
/// taken to grow with them.
MovingPairs choose_moving(const PairList& pairs, std::span<const Contact> contacts, double share);

} // namespace raycontact
