// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

namespace raycontact {

/// Each number becomes the sum of all up to it, on all threads.
template <class T>
void sum_up(Executor& executor, std::span<T> numbers) {
    constexpr std::size_t few = 1 << 15, parts = 64;
    if (numbers.size() <= few || executor.threads() == 1) {
        std::partial_sum(numbers.begin(), numbers.end(), numbers.begin());
        return;
    }
    const std::size_t size = (numbers.size() + parts - 1) / parts;
    const auto part = [&](std::size_t i) {
        const std::size_t begin = std::min(numbers.size(), i * size);
        return numbers.subspan(begin, std::min(size, numbers.size() - begin));
    };
    std::array<T, parts> before{};
    executor.each(parts, 1, [&](std::uint32_t i) {
        const auto own = part(i);
        std::partial_sum(own.begin(), own.end(), own.begin());
    });
    for (std::size_t i = 1; i < parts; ++i) {
        const auto last = part(i - 1);
        before[i] = before[i - 1] + (last.empty() ? 0 : last.back());
    }
    executor.each(parts, 1, [&](std::uint32_t i) {
        for (T& number : part(i)) number += before[i];
    });
}

} // namespace raycontact
