// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slot_pair.h"

#include <cstdint>

namespace raycontact {

/// A ray that the next step follows.
struct KeptRay {
    SlotPair pair;
    bool from_a = false;        ///< its vertex is one of the pair's first body
    std::uint32_t vertex = 0;   ///< of the source's shape
    std::uint32_t triangle = 0; ///< of the other shape, where the walk begins
};

} // namespace raycontact
