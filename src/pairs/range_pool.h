// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <bit>
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
    /// Throws InputError beyond 2^31 elements.
    Range allocate(std::uint32_t count) {
        if (count == 0) return {};
        if (count > 1u << 30)
            throw InputError("a pair has more than 2^30 vertex blocks as candidates; split its meshes");
        const std::uint32_t capacity = std::bit_ceil(std::max(count, 4u));
        std::vector<std::uint32_t>& free = free_of(capacity);
        Range range{end_, capacity};
        if (!free.empty()) {
            range.first = free.back();
            free.pop_back();
        } else {
            if (end_ > (1u << 31) - capacity)
                throw InputError(
                    "the pairs of this scene have more than 2^31 vertex blocks as candidates; give a step fewer");
            end_ += capacity;
        }
        in_use_ += capacity;
        return range;
    }
    void release(Range range) {
        if (range.capacity == 0) return;
        free_of(range.capacity).push_back(range.first);
        in_use_ -= range.capacity;
    }
    void clear() { *this = {}; }

    std::uint32_t end() const { return end_; }       ///< the array must be this long
    std::uint64_t in_use() const { return in_use_; } ///< elements of the allocated ranges

private:
    std::vector<std::uint32_t>& free_of(std::uint32_t capacity) {
        return free_[static_cast<std::size_t>(std::countr_zero(capacity))];
    }

    std::array<std::vector<std::uint32_t>, 32> free_; ///< by the power of two
    std::uint32_t end_ = 0;
    std::uint64_t in_use_ = 0;
};

} // namespace raycontact
