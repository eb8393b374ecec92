// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>
#include <utility>

namespace raycontact {

/// BodyId::slot
using BodySlot = std::uint32_t;

/// An unordered pair of bodies by their slots, first < second.
using SlotPair = std::pair<BodySlot, BodySlot>;
inline SlotPair pair_of(const Contact& contact) {
    return {contact.body_a.slot, contact.body_b.slot};
}

} // namespace raycontact
