// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "pairs/directed_pairs.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace raycontact {

using kernels::NearEdge;

/// An edge is short up to this, in diagonals of the smaller body (docs/edges.md).
inline constexpr double short_edge = 0.2;

/// Whether edges can be in contact at all: of two open meshes vertices alone decide.
inline bool asks_edges(const PlacedBody& a, const PlacedBody& b) {
    return a.shape->has_inside() || b.shape->has_inside();
}

/// Metres: shorter edges of a pair in contact need not be found. A little less than what the rule leaves out.
inline double short_length(const PlacedBody& a, const PlacedBody& b) {
    return 0.9999 * short_edge * smaller_size(a, b);
}
/// Whether all edges of both bodies are.
inline bool has_short_edges_alone(const PlacedBody& a, const PlacedBody& b) {
    return std::max(a.shape->data().longest_edge, b.shape->data().longest_edge) < short_length(a, b);
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
