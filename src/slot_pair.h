// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>
#include <utility>

namespace raycontact {

/// The place of a body in its scene; reused once the body is removed (BodyId also tells which body had it when).
using BodySlot = std::uint32_t;

/// An unordered pair of bodies by their slots, first < second.
using SlotPair = std::pair<BodySlot, BodySlot>;
inline SlotPair pair_of(const Contact& contact) {
    return {contact.body_a, contact.body_b};
}

} // namespace raycontact
