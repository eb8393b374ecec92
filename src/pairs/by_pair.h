// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/row_slices.h"
#include "executor/sum_up.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What a step found for directed pairs, in the order of the pairs. T::pair is then a directed index (DirectedBodies).
template <class T>
class ByPair {
public:
    /// found: directed(found.pair) is the directed index of one of pair_count pairs. Those of one lie in a row, and
    /// keep their order.
    template <class Directed>
    void set(Executor& executor, std::span<const T> found, Directed&& directed, std::size_t pair_count) {
        firsts_.resize(2 * pair_count + 1);
        executor.run(static_cast<std::uint32_t>(firsts_.size()), 1 << 15, [&](std::uint32_t begin, std::uint32_t end) {
            std::fill(firsts_.begin() + begin, firsts_.begin() + end, 0);
        });
        const RowSlices slices{found.size(), 512};
        const auto belongs = [&](std::size_t i) { return found[i].pair == found[i - 1].pair; };
        slices.each_row(executor, belongs, [&](std::size_t begin, std::size_t end) {
            firsts_[directed(found[begin].pair) + 1] = static_cast<std::uint32_t>(end - begin);
        });
        sum_up(executor, std::span(firsts_));
        all_.resize(found.size());
        slices.each_row(executor, belongs, [&](std::size_t begin, std::size_t end) {
            const std::uint32_t pair = directed(found[begin].pair);
            for (T* own = &all_[firsts_[pair]]; begin < end; ++begin, ++own) {
                *own = found[begin];
                own->pair = pair;
            }
        });
    }
    std::span<const T> all() const { return all_; }
    /// Of a directed pair: the place of its first; all of them.
    std::uint32_t first(std::size_t directed) const { return firsts_[directed]; }
    std::span<const T> of(std::size_t directed) const {
        return all().subspan(first(directed), firsts_[directed + 1] - first(directed));
    }
    std::span<T> of(std::size_t directed) {
        return std::span(all_).subspan(first(directed), firsts_[directed + 1] - first(directed));
    }

private:
    std::vector<T> all_;
    std::vector<std::uint32_t> firsts_{0}; ///< by directed index, and one more
};

} // namespace raycontact
