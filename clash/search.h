// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <clash/parts.h>

#include <raycontact/contact.h>

namespace raycontact::clash {

/// Two parts that share a point.
struct Clash {
    std::size_t a = 0, b = 0; ///< numbers of the parts, a < b
    double depth = 0;         ///< of the deepest contact, metres; 0: they touch, or no rule of contact applies
    Vec3 point;               ///< between the witness points of that contact; else one that they share (common_point)
    Vec3 normal;              ///< of that contact, unit, from a to b; else 0
    std::size_t contacts = 0;
    bool duplicate = false; ///< copies in one place (are_duplicates): depth, point and contacts are those of copies
                            ///< 2e-6 of their size apart, as faces that coincide say nothing of a depth
};

struct SearchOptions {
    std::uint32_t threads = 0; ///< 0: one per core
    std::function<void(std::size_t done, std::size_t total)> progress = [](std::size_t, std::size_t) {};
    std::function<bool()> stop = [] { return false; }; ///< asked between pairs; true: the search ends there
};

/// Every pair that shares a point (raycontact::intersects), deepest first; ties in the parts' order. Pairs of parts
/// with a fault are left out.
std::vector<Clash> find_clashes(const std::vector<Part>& parts, const std::vector<PartPair>& pairs,
                                const SearchOptions& options);

} // namespace raycontact::clash
