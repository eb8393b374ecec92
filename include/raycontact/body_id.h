// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace raycontact {

/// Names one body of one scene and is never reused. The low 32 bits are the body's slot, the high 32 its generation:
/// how many bodies had that slot before. As long as nothing has been removed, ids are 0, 1, 2, ..., like slots.
/// Contacts hold slots: compare those with slot_of(id), never with the id itself.
using BodyId = std::uint64_t;

constexpr std::uint32_t slot_of(BodyId body) {
    return static_cast<std::uint32_t>(body);
}
constexpr std::uint32_t generation_of(BodyId body) {
    return static_cast<std::uint32_t>(body >> 32);
}
constexpr BodyId body_id(std::uint32_t slot, std::uint32_t generation) {
    return BodyId{generation} << 32 | slot;
}

} // namespace raycontact
