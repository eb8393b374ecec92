// SPDX-License-Identifier: Apache-2.0
#include "pairs/range_pool.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace raycontact {

RangePool::Range RangePool::allocate(std::uint32_t count) {
    if (count == 0) return {};
    if (count > 1u << 30) throw std::length_error("a pair watches more than 2^30 vertex blocks; split its meshes");
    const std::uint32_t capacity = std::bit_ceil(std::max(count, 4u));
    std::vector<std::uint32_t>& free = free_[static_cast<std::size_t>(std::countr_zero(capacity))];
    Range range{end_, capacity};
    if (!free.empty()) {
        range.first = free.back();
        free.pop_back();
    } else {
        if (end_ > (1u << 31) - capacity)
            throw std::length_error("the pairs of this scene watch more than 2^31 vertex blocks; give a step fewer");
        end_ += capacity;
    }
    in_use_ += capacity;
    return range;
}

void RangePool::release(Range range) {
    if (range.capacity == 0) return;
    free_[static_cast<std::size_t>(std::countr_zero(range.capacity))].push_back(range.first);
    in_use_ -= range.capacity;
}

} // namespace raycontact
