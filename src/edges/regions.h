// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/disjoint_sets.h"

#include <utility>

namespace raycontact {

/// Sets of crossings and vertices that belong together (docs/edges.md, "Regions").
class Regions : public DisjointSets {
public:
    void reset(std::size_t count) {
        DisjointSets::reset(count);
        keys_.clear(); // a step that failed half-way left some
    }
    /// Joins all that have a key in common, when join_keys() is called.
    void add_key(std::uint64_t key, std::uint32_t i) { keys_.emplace_back(key, i); }
    void join_keys();

private:
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;
};

} // namespace raycontact
