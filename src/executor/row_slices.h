// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace raycontact {

/// Slices of a list in which some elements in a row belong together, as the contacts of a pair do: a slice has whole
/// rows. Their number depends on the list alone.
struct RowSlices {
    std::size_t size;        ///< of the list
    std::size_t step = 1024; ///< a slice has the rows that begin in so many elements

    /// Of an empty list one, which is empty.
    std::size_t count() const { return size == 0 ? 1 : (size + step - 1) / step; }

    /// Calls work(slice, begin, end) for each, on all threads. belongs(i): whether element i is in the row of i - 1.
    template <class Belongs, class Work>
    void each(Executor& executor, Belongs&& belongs, Work&& work) const {
        executor.each(count(), 1, [&](std::uint32_t slice) {
            const std::size_t last = std::min(size, (slice + std::size_t{1}) * step);
            std::size_t begin = slice * step, end = last;
            while (begin > 0 && begin < last && belongs(begin)) ++begin;
            if (begin == last && slice > 0) return; // no row begins here
            while (end < size && belongs(end)) ++end;
            work(slice, begin, end);
        });
    }
    /// Calls work(begin, end) for each row.
    template <class Belongs, class Work>
    void each_row(Executor& executor, Belongs&& belongs, Work&& work) const {
        each(executor, belongs, [&](std::uint32_t, std::size_t begin, std::size_t end) {
            for (std::size_t next = begin; begin < end; begin = next) {
                while (++next < end && belongs(next)) {
                }
                work(begin, next);
            }
        });
    }
};

/// What of another sorted list goes with the elements [begin, end) of one of `size`: what is not before the key of the
/// first, and before that of the first behind them. All of it goes with one slice or another. key(i): of an element.
template <class T, class Key, class Projection = std::identity>
std::span<const T> beside(std::span<const T> list, std::size_t begin, std::size_t end, std::size_t size, Key&& key,
                          Projection projection = {}) {
    const auto at = [&](std::size_t i) {
        return static_cast<std::size_t>(std::ranges::lower_bound(list, key(i), {}, projection) - list.begin());
    };
    const std::size_t first = begin == 0 ? 0 : at(begin);
    return list.subspan(first, (end == size ? list.size() : at(end)) - first);
}

} // namespace raycontact
