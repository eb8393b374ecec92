// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <clash/parts.h>

#include <raycontact/contact.h>

#include <optional>

namespace raycontact::clash {

/// Two parts that share a point.
struct Clash {
    std::size_t a = 0, b = 0; ///< numbers of the parts, a < b
    /// Of the deepest contact, metres; 0: they touch. None: they share a point, and no rule of contact gives a depth,
    /// as one of them is open, intersects itself or winds the wrong way somewhere.
    std::optional<double> depth = 0;
    Vec3 point;  ///< of that contact: on one part's surface, in the other; else one that they share (common_point)
    Vec3 normal; ///< of that contact, unit, from a to b; else 0
    std::size_t contacts = 0;
    bool duplicate = false; ///< copies in one place (are_duplicates)
};

struct SearchOptions {
    std::uint32_t threads = 0; ///< 0: one per core
    std::function<void(std::size_t done, std::size_t total)> progress = [](std::size_t, std::size_t) {};
    std::function<bool()> stop = [] { return false; }; ///< asked between pairs; true: the search ends there
};

/// Every pair that shares a point (raycontact::intersects), deepest first, then those without a depth, then those that
/// touch; ties in the parts' order. Where faces coincide, contacts_when_nudged() tells touching parts from others.
/// Pairs of parts with a fault are left out.
std::vector<Clash> find_clashes(const std::vector<Part>& parts, const std::vector<PartPair>& pairs,
                                const SearchOptions& options);

} // namespace raycontact::clash
