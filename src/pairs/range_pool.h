// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace raycontact {

/// Allocates ranges of an array whose elements live as long as a pair does. Capacities are powers of two, so that a
/// released range fits a later request; deterministic.
class RangePool {
public:
    struct Range {
        std::uint32_t first = 0, capacity = 0;
    };
    /// Throws std::length_error beyond 2^31 elements.
    Range allocate(std::uint32_t count);
    void release(Range range);
    void clear() { *this = {}; }

    std::uint32_t end() const { return end_; }       ///< the array must be this long
    std::uint64_t in_use() const { return in_use_; } ///< elements of the allocated ranges

private:
    std::array<std::vector<std::uint32_t>, 32> free_; ///< by the power of two
    std::uint32_t end_ = 0;
    std::uint64_t in_use_ = 0;
};

} // namespace raycontact
