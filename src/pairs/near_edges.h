// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>

#include "device/host_kernels.h"
#include "pairs/directed_pairs.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace raycontact {

using kernels::NearEdge;

/// Where a vertex of a pair is in contact, an edge counts if it hides more than this part of the smaller body's
/// diagonal; one that ends at such a vertex, more than the second (docs/internals/edges.md).
inline constexpr double least_hidden = 0.01, least_hidden_beside = 0.1;

/// Metres: an edge of a pair in contact that hides less need not be found. A little less than what the rule leaves out.
inline double hidden_length(const PlacedBody& a, const PlacedBody& b) {
    return 0.9999 * least_hidden * smaller_size(a, b);
}
/// Whether an edge of either body hides more than a part of the smaller one.
inline bool hides_more(const PlacedBody& a, const PlacedBody& b, double part) {
    return std::max(a.shape->data().hides_most, b.shape->data().hides_most) > 0.9999 * part * smaller_size(a, b);
}

/// Metres: two edges of which the root of the product of what both hide is less have no speculative contact while the
/// pair does not hurry (docs/internals/speculative.md).
inline double least_hidden_ahead(const PlacedBody& a, const PlacedBody& b, double margin) {
    return 0.1 * std::min(margin, speculative_share * smaller_size(a, b));
}
/// Whether most edges of a hide less than that: then those that hide more are sought, of either body.
inline bool seeks_what_hides(const PlacedBody& a, const PlacedBody& b, double margin) {
    return a.shape->data().hides_half < least_hidden_ahead(a, b, margin) && margin < smaller_size(a, b);
}

/// Calls visit(edge or vertex, its near faces) for each, of a list in which those of each are together.
template <class Visit>
void by_source(std::span<const NearEdge> near, Visit&& visit) {
    for (std::size_t begin = 0, end = 0; begin < near.size(); begin = end) {
        while (end < near.size() && near[end].edge == near[begin].edge) ++end;
        visit(near[begin].edge, near.subspan(begin, end - begin));
    }
}

/// Of a pair: the edges of a near b, and those of b near a; each sorted by edge and face.
using NearEdges = std::array<std::span<const NearEdge>, 2>;

/// A pair that is asked in a step.
struct AskedPair {
    std::uint32_t pair;                      ///< its place
    bool edges;                              ///< whether surfaces cross, or one body is inside the other
    std::array<std::span<NearEdge>, 2> near; ///< as NearEdges, in any order
    /// Neither surface crosses the other and neither body is inside the other while `near` lasts. Null: nothing is kept
    /// of the pair.
    bool* apart = nullptr;
};

} // namespace raycontact
