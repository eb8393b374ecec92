// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace raycontact {

/// What a step found for directed pairs, in the order of the pairs. T::pair is then a directed index (DirectedBodies).
template <class T>
class ByPair {
public:
    /// found: each names its pair by an index of `directed`, which has the directed indices of some of pair_count
    /// pairs. Those of one pair keep their order.
    void set(std::span<const T> found, std::span<const std::uint32_t> directed, std::size_t pair_count) {
        ends_.assign(2 * pair_count + 1, 0);
        for (const T& one : found) ++ends_[directed[one.pair] + 1];
        std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
        all_.resize(found.size());
        for (const T& one : found) {
            const std::uint32_t pair = directed[one.pair];
            T& own = all_[ends_[pair]++];
            own = one;
            own.pair = pair;
        }
    }
    std::span<const T> all() const { return all_; }
    /// Of a directed pair: the place of its first; all of them.
    std::uint32_t first(std::size_t directed) const { return directed == 0 ? 0 : ends_[directed - 1]; }
    std::span<const T> of(std::size_t directed) const {
        return all().subspan(first(directed), ends_[directed] - first(directed));
    }
    std::span<T> of(std::size_t directed) {
        return std::span(all_).subspan(first(directed), ends_[directed] - first(directed));
    }

private:
    std::vector<T> all_;
    std::vector<std::uint32_t> ends_; ///< by directed index
};

} // namespace raycontact
