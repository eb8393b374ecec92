// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Slices of a list in which some elements in a row belong together, as the contacts of a pair do: a slice has whole
/// rows. Their number depends on the list alone.
struct RowSlices {
    std::size_t size;        ///< of the list
    std::size_t step = 1024; ///< a slice has the rows that begin in so many elements

    std::size_t count() const { return (size + step - 1) / step; }

    /// Calls work(slice, begin, end) for each, on all threads. belongs(i): whether element i is in the row of i - 1.
    template <class Belongs, class Work>
    void each(Executor& executor, Belongs&& belongs, Work&& work) const {
        executor.each(count(), 1, [&](std::uint32_t slice) {
            const std::size_t last = std::min(size, (slice + std::size_t{1}) * step);
            std::size_t begin = slice * step, end = last;
            while (begin > 0 && begin < last && belongs(begin)) ++begin;
            if (begin == last) return; // no row begins here
            while (end < size && belongs(end)) ++end;
            work(slice, begin, end);
        });
    }
};

/// The values themselves, on all threads.
template <class T>
void copy_all(Executor& executor, std::span<const T> from, std::vector<T>& to) {
    to.resize(from.size());
    executor.run(static_cast<std::uint32_t>(from.size()), 8192, [&](std::uint32_t begin, std::uint32_t end) {
        std::copy(from.begin() + begin, from.begin() + end, to.begin() + begin);
    });
}

} // namespace raycontact
