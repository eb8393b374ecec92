// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include <array>
#include <cstdint>
#include <span>

namespace raycontact {

using kernels::NearEdge;

/// An edge is short up to this, in diagonals of the smaller body (docs/edges.md).
inline constexpr double short_edge = 0.2;

/// Of a pair: the edges of a near b, and those of b near a; each sorted by edge and face.
using NearEdges = std::array<std::span<const NearEdge>, 2>;

/// A pair that edges ask in a step.
struct AskedPair {
    std::uint32_t pair;                      ///< its place
    std::array<std::span<NearEdge>, 2> near; ///< as NearEdges, in any order
    /// Neither surface crosses the other and neither body is inside the other while `near` lasts. Null: nothing is kept
    /// of the pair.
    bool* apart = nullptr;
};

} // namespace raycontact
