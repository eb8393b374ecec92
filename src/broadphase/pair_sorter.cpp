// SPDX-License-Identifier: Apache-2.0
#include "broadphase/pair_sorter.h"

#include "executor/sum_up.h"

#include <algorithm>
#include <atomic>

namespace raycontact {

void PairSorter::run(Executor& executor, std::size_t slots, std::span<const std::span<const SlotPair>> lists,
                     std::vector<SlotPair>& sorted) {
    ends_.assign(slots + 1, 0);
    // Which thread comes first decides the order of a body's pairs, which are sorted after that.
    const bool alone = executor.threads() == 1;
    const auto next = [&](std::size_t& number) {
        return alone ? number++ : std::atomic_ref(number).fetch_add(1, std::memory_order_relaxed);
    };
    executor.each(lists.size(), 16, [&](std::uint32_t i) {
        for (const SlotPair& pair : lists[i]) next(ends_[pair.first + std::size_t{1}]);
    });
    sum_up(executor, std::span(ends_));
    sorted.resize(ends_.back());
    executor.each(lists.size(), 16, [&](std::uint32_t i) {
        for (const SlotPair& pair : lists[i]) sorted[next(ends_[pair.first])] = pair;
    });
    executor.each(slots, 1024, [&](std::uint32_t body) {
        const auto begin = sorted.begin() + std::ptrdiff_t(body == 0 ? 0 : ends_[body - std::size_t{1}]);
        std::sort(begin, sorted.begin() + std::ptrdiff_t(ends_[body]));
    });
}

void PairSorter::run(Executor& executor, std::size_t slots, std::span<const SlotPair> pairs,
                     std::vector<SlotPair>& sorted) {
    constexpr std::size_t at_once = 256;
    pieces_.clear();
    for (std::size_t begin = 0; begin < pairs.size(); begin += at_once)
        pieces_.push_back(pairs.subspan(begin, std::min(at_once, pairs.size() - begin)));
    run(executor, slots, pieces_, sorted);
}

} // namespace raycontact
