// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace raycontact {

/// Divides work that is split in two again and again: large parts level by level, all of a level side by side, until
/// none is left; returns the others. split(part) gives the halves, on any thread. settle(part, halves), if there is
/// one, is called after a level for each of its parts in turn, and may still change the halves.
template <class Part, class IsLarge, class Split, class Settle>
std::vector<Part> divide(Executor& executor, Part whole, IsLarge&& is_large, Split&& split, Settle&& settle) {
    std::vector<Part> open{whole}, parts;
    while (!open.empty()) {
        const auto first_small = std::stable_partition(open.begin(), open.end(), is_large);
        parts.insert(parts.end(), first_small, open.end());
        open.erase(first_small, open.end());
        std::vector<std::array<Part, 2>> halves(open.size());
        executor.each(open.size(), 1, [&](std::uint32_t i) { halves[i] = split(open[i]); });
        std::vector<Part> next;
        for (std::size_t i = 0; i < open.size(); ++i) {
            settle(open[i], halves[i]);
            next.insert(next.end(), halves[i].begin(), halves[i].end());
        }
        open = std::move(next);
    }
    return parts;
}
template <class Part, class IsLarge, class Split>
std::vector<Part> divide(Executor& executor, Part whole, IsLarge&& is_large, Split&& split) {
    return divide(executor, whole, is_large, split, [](const Part&, std::array<Part, 2>&) {});
}

/// Calls work(part) for each, on the executor's threads.
template <class Part, class Work>
void for_each_part(Executor& executor, const std::vector<Part>& parts, Work&& work) {
    executor.each(parts.size(), 1, [&](std::uint32_t i) { work(parts[i]); });
}

} // namespace raycontact
