// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/edges.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::reference {

/// Sums of any number of comparisons of the contacts of edges and of bodies inside others.
struct EdgeComparison {
    std::uint64_t pairs = 0;
    std::uint64_t pairs_excused = 0; ///< passed over: of other vertices in contact, so near a tie of theirs
    std::uint64_t contacts = 0;      ///< found by the reference
    std::uint64_t agreed = 0;        ///< alike in key, triangle, point, normal, depth and weight
    std::uint64_t inside = 0;        ///< of these: bodies inside others
    std::uint64_t excused = 0; ///< differ, but the reference itself says so of a pose that differs by `excuse_edges`
    std::uint64_t wrong = 0;   ///< differ without excuse
    double worst_normal = 0;   ///< over the contacts that agree
    double worst_depth = 0;    ///< relative to the larger diagonal, as is the point
    double worst_point = 0;
    std::vector<std::string> complaints; ///< the first few wrong ones in words
    std::string summary() const;
};

/// How far a body is moved at most to learn whether a contact hangs on rounding, relative to the larger diagonal.
constexpr double excuse_edges = 5e-6;

/// Holds the library's contacts of one pair of bodies against the reference; those of vertices are passed over.
void compare_edges(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                   std::span<const Contact> contacts, EdgeComparison& sum,
                   Direction direction = Direction::reprojected);

} // namespace raycontact::reference
