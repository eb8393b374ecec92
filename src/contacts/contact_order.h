// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slot_pair.h"

#include <raycontact/contact.h>

#include <cstdint>
#include <utility>

namespace raycontact {

/// The slots of a pair in one number, in the order of pairs.
inline std::uint64_t pair_number(const SlotPair& pair) {
    return std::uint64_t{pair.first} << 32 | pair.second;
}
inline std::uint64_t number_of_pair(const Contact& contact) {
    return pair_number(pair_of(contact));
}

/// What contacts are sorted by: the pair, then the key.
using ContactOrder = std::pair<std::uint64_t, std::uint64_t>;
inline ContactOrder order_of(BodyId a, BodyId b, std::uint64_t key) {
    return {pair_number({a.slot, b.slot}), key};
}
inline ContactOrder order_of(const Contact& contact) {
    return {number_of_pair(contact), contact.key()};
}

} // namespace raycontact
