// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "slot_pair.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// A pair and its slot (PairSlots).
struct OpenPair {
    SlotPair pair;
    std::uint32_t slot;
    auto operator<=>(const OpenPair&) const = default; // NOLINT(modernize-use-nullptr): of clang-tidy 14
};

/// Pairs in order, and their slots.
struct PairList {
    std::vector<SlotPair> pairs;
    std::vector<std::uint32_t> slots;

    std::size_t size() const { return pairs.size(); }
    void resize(std::size_t size) {
        pairs.resize(size);
        slots.resize(size);
    }
    void add(const OpenPair& open) {
        pairs.push_back(open.pair);
        slots.push_back(open.slot);
    }
    void set(std::size_t i, const OpenPair& open) {
        pairs[i] = open.pair;
        slots[i] = open.slot;
    }
    /// sorted: in order.
    void assign(Executor& executor, std::span<const OpenPair> sorted) {
        resize(sorted.size());
        executor.each(sorted.size(), 8192, [&](std::uint32_t i) { set(i, sorted[i]); });
    }
    /// Those that are in a sorted list, too.
    void keep_only(std::span<const SlotPair> wanted) {
        std::size_t kept = 0;
        auto at = wanted.begin();
        for (std::size_t i = 0; i < size(); ++i) {
            while (at != wanted.end() && *at < pairs[i]) ++at;
            if (at != wanted.end() && *at == pairs[i]) set(kept++, {pairs[i], slots[i]});
        }
        resize(kept);
    }
};

} // namespace raycontact
