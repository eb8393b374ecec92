// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "executor/sum_up.h"
#include "pairs/pair_list.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Sorts pairs: a few as they are, many by counting those of each first body, then each body's by the second.
template <class T>
class PairSorter {
public:
    /// lists: of pairs of bodies below `slots`, in any order. sorted: becomes all of them.
    void run(Executor& executor, std::size_t slots, std::span<const std::span<const T>> lists, std::vector<T>& sorted) {
        constexpr std::size_t few = 16;
        std::size_t count = 0;
        for (const std::span<const T> list : lists) count += list.size();
        if (count < slots / few) {
            sorted.clear();
            for (const std::span<const T> list : lists) sorted.insert(sorted.end(), list.begin(), list.end());
            std::ranges::sort(sorted);
            return;
        }
        ends_.assign(slots + 1, 0);
        // Which thread comes first decides the order of a body's pairs, which are sorted after that.
        const bool alone = executor.threads() == 1;
        const auto next = [&](std::size_t& number) {
            return alone ? number++ : std::atomic_ref(number).fetch_add(1, std::memory_order_relaxed);
        };
        executor.each(lists.size(), 16, [&](std::uint32_t i) {
            for (const T& pair : lists[i]) next(ends_[first_of(pair) + std::size_t{1}]);
        });
        sum_up(executor, std::span(ends_));
        sorted.resize(ends_.back());
        executor.each(lists.size(), 16, [&](std::uint32_t i) {
            for (const T& pair : lists[i]) sorted[next(ends_[first_of(pair)])] = pair;
        });
        executor.each(slots, 1024, [&](std::uint32_t body) {
            const auto begin = sorted.begin() + std::ptrdiff_t(body == 0 ? 0 : ends_[body - std::size_t{1}]);
            std::sort(begin, sorted.begin() + std::ptrdiff_t(ends_[body]));
        });
    }
    /// The same of one list.
    void run(Executor& executor, std::size_t slots, std::span<const T> pairs, std::vector<T>& sorted) {
        constexpr std::size_t at_once = 256;
        pieces_.clear();
        for (std::size_t begin = 0; begin < pairs.size(); begin += at_once)
            pieces_.push_back(pairs.subspan(begin, std::min(at_once, pairs.size() - begin)));
        run(executor, slots, pieces_, sorted);
    }

private:
    static BodySlot first_of(const SlotPair& pair) { return pair.first; }
    static BodySlot first_of(const OpenPair& open) { return open.pair.first; }

    std::vector<std::span<const T>> pieces_;
    std::vector<std::size_t> ends_; ///< by slot, and one more
};

} // namespace raycontact
