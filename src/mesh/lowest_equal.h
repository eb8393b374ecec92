// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "interruption.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <xxhash.h>

namespace raycontact {

/// The lowest index of an equal item, for each item, in linear time; -0 and 0 must have been made equal. Open
/// addressing; items are visited in order, so the first of its kind is the lowest. No result depends on the hash.
template <class Item>
std::vector<std::uint32_t> lowest_equal(const std::vector<Item>& items) {
    constexpr std::uint32_t empty = 0xffffffffu;
    const std::size_t slots = std::bit_ceil(2 * items.size() + 1);
    std::vector<std::uint32_t> table(slots, empty), lowest;
    lowest.reserve(items.size());
    const InterruptionCheck check;
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        check();
        std::size_t slot = XXH3_64bits(&items[i], sizeof(Item)) & (slots - 1);
        while (table[slot] != empty && items[table[slot]] != items[i]) slot = (slot + 1) & (slots - 1);
        if (table[slot] == empty) table[slot] = i;
        lowest.push_back(table[slot]);
    }
    return lowest;
}

} // namespace raycontact
