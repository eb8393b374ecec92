// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/loops.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// A part of an edge inside the other body, from a crossing or the edge's end to the next.
struct EdgePiece {
    std::uint32_t side, edge;
    std::array<std::uint32_t, 2> crossings; ///< at its ends; NONE: it ends at a vertex there
    std::array<Vec3, 2> ends;               ///< frame of PairMeshes

    bool is_through() const { return crossings[0] != NONE && crossings[1] != NONE; }
    /// Any of its crossings.
    std::uint32_t crossing() const { return crossings[0] == NONE ? crossings[1] : crossings[0]; }
    /// Of one that is not through: which end is a vertex.
    std::size_t vertex_end() const { return crossings[0] == NONE ? 0 : 1; }
    Vec3 middle() const { return 0.5 * (ends[0] + ends[1]); }
};

/// A vertex of the pair: its side in the upper half, its number in the lower.
inline std::uint64_t vertex_of_side(std::size_t side, std::uint32_t vertex) {
    return std::uint64_t{side} << 32 | vertex;
}
/// The vertex at the end of a piece that is not through.
inline std::uint64_t vertex_of(const PairMeshes& pair, const EdgePiece& piece) {
    return vertex_of_side(piece.side, ends_of(pair.shape(piece.side), piece.edge)[piece.vertex_end()]);
}

/// Cuts the edges of a pair where they cross faces.
class EdgePieces {
public:
    void list(const PairMeshes& pair, std::span<const Crossing> crossings);
    /// As their edges are numbered, and along these.
    std::span<const EdgePiece> all() const { return pieces_; }
    /// The edges that cross a face, by their vertices, the lower one first; sorted.
    std::span<const std::array<std::uint64_t, 2>> crossed() const { return crossed_; }

private:
    std::vector<std::uint32_t> by_edge_; ///< crossings, those of an edge along it
    std::vector<EdgePiece> pieces_;
    std::vector<std::array<std::uint64_t, 2>> crossed_;
};

} // namespace raycontact
