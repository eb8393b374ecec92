// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace raycontact {

/// Hands out ranges of an array whose elements live as long as a pair does. Sizes are powers of two, so that a range
/// given back fits the next that is asked for; deterministic.
class RangePool {
public:
    struct Range {
        std::uint32_t first = 0, capacity = 0;
    };
    /// Throws std::length_error beyond 2^31 elements.
    Range take(std::uint32_t count);
    void give_back(Range range);
    void clear();

    std::uint32_t end() const { return end_; }       ///< the array must be this long
    std::uint64_t in_use() const { return in_use_; } ///< elements of the ranges handed out

private:
    std::array<std::vector<std::uint32_t>, 32> free_; ///< by the power of two
    std::uint32_t end_ = 0;
    std::uint64_t in_use_ = 0;
};

} // namespace raycontact
