// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>
#include <utility>

namespace raycontact {

/// The slots of a pair in one number, in the order of pairs.
inline std::uint64_t pair_number(const Contact& contact) {
    return std::uint64_t{contact.body_a.slot} << 32 | contact.body_b.slot;
}

/// What contacts are sorted by: the pair, then the key.
using ContactOrder = std::pair<std::uint64_t, std::uint64_t>;
inline ContactOrder order_of(BodyId a, BodyId b, std::uint64_t key) {
    return {std::uint64_t{a.slot} << 32 | b.slot, key};
}
inline ContactOrder order_of(const Contact& contact) {
    return {pair_number(contact), contact.key()};
}

} // namespace raycontact
