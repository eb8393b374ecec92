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
    std::size_t size;         ///< of the list
    std::size_t least = 1024; ///< elements of a slice, but for the last

    std::size_t count() const { return (size + least - 1) / least; }

    /// Calls work(slice, begin, end) for each, on all threads. belongs(i): whether element i is in the row of i - 1.
    template <class Belongs, class Work>
    void each(Executor& executor, Belongs&& belongs, Work&& work) const {
        const auto begin_of = [&](std::size_t slice) {
            std::size_t at = std::min(size, slice * least);
            while (at > 0 && at < size && belongs(at)) ++at;
            return at;
        };
        executor.each(count(), 1, [&](std::uint32_t slice) {
            const std::size_t begin = begin_of(slice), end = begin_of(slice + std::size_t{1});
            if (begin < end) work(slice, begin, end);
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
