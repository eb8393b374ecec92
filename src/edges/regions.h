// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace raycontact {

/// Sets of things that belong together: union and find, numbered by the lowest member, so that the order of the unions
/// does not matter.
class Regions {
public:
    void reset(std::size_t count) {
        parents_.resize(count);
        for (std::size_t i = 0; i < count; ++i) parents_[i] = static_cast<std::uint32_t>(i);
        keys_.clear();
    }
    std::uint32_t of(std::uint32_t i) {
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = of(a);
        b = of(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }
    /// Joins all that have a key in common, when join_keys() is called.
    void add_key(std::uint64_t key, std::uint32_t i) { keys_.emplace_back(key, i); }
    void join_keys();

private:
    std::vector<std::uint32_t> parents_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;
};

} // namespace raycontact
