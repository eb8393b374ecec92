// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/pair_meshes.h"
#include "pairs/displacement.h"
#include "pairs/near_edges.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// A pair whose speculative contacts are asked for (docs/internals/speculative.md): what is nearer than a margin, and
/// what will touch on its way to the next step. They are found in double, so they are the same for every device.
struct SpeculativePair {
    SpeculativePair(const PlacedBody& first, const PlacedBody& second, double within);

    const PlacedBody &a, &b;
    double margin;       ///< metres
    PairPlace now, next; ///< of b's frame
    std::array<double, 2>
        ways; ///< how far a vertex of a, of b, may go in the other's frame until the next step, metres
};

/// Adds those of vertices in any order. near: vertices and the faces that they may come near, each vertex's together.
/// touching: the vertices of a, of b, in contact, sorted; they have no other.
void find_speculative_vertices(const SpeculativePair& pair, const NearEdges& near,
                               const std::array<std::span<const std::uint32_t>, 2>& touching,
                               std::vector<FeatureContact>& found);

/// Adds those of two edges in any order, but for those that `found` has already. near: as NearEdges. told: a vertex of
/// the pair has a contact, of whatever kind: then, as of a pair that goes far in a step, only edges that hide much are
/// asked (docs/internals/edges.md).
void find_speculative_edges(const SpeculativePair& pair, bool told, const NearEdges& near,
                            std::vector<FeatureContact>& found);

} // namespace raycontact
