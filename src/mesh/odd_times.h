// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace raycontact {

/// Leaves each number once that is there an odd number of times, ascending.
inline void keep_odd_times(std::vector<std::uint32_t>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    std::size_t kept = 0;
    for (const std::uint32_t number : numbers) {
        if (kept > 0 && numbers[kept - 1] == number)
            --kept;
        else
            numbers[kept++] = number;
    }
    numbers.resize(kept);
}

} // namespace raycontact
