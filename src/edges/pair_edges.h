// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/regions.h"
#include "edges/way_out.h"
#include "pairs/near_edges.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// The edges' rule for one pair (docs/internals/edges.md). Keeps nothing but memory from one pair to the next.
class PairEdges {
public:
    /// near: the edges that could cross. vertices: the vertex contacts of a, of b.
    /// Adds contacts in any order; returns whether any edge crosses a face.
    bool find(const PairMeshes& pair, const NearEdges& near,
              const std::array<std::span<const kernels::LocalContact>, 2>& vertices,
              std::vector<FeatureContact>& found);

private:
    /// What a region may say.
    struct Candidate {
        std::uint32_t region, number; ///< number: in the order in which they are found
        Vec3 normal;                  ///< out of b
        FeatureContact contact;
    };
    /// Regions whose sharp, convex edges have no way say what they can: with any way of these, then with any edge.
    enum class Effort { edges_alone, any_way, any_edge };

    void list_vertices(const std::array<std::span<const kernels::LocalContact>, 2>& vertices);
    void follow_loops(const PairMeshes& pair, const NearEdges& near);
    std::uint32_t region_of(const EdgePiece& piece) const { return regions_.of_crossing(piece.crossing()); }
    bool speaks(const PairMeshes& pair, const EdgePiece& piece) const;
    bool is_hidden(const Region& region, double depth, const Vec3& way) const;
    void list_inner_vertices(const PairMeshes& pair);
    const TouchingVertex* touching(const PairMeshes& pair, const EdgePiece& piece) const;
    bool leads_out(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way);
    void list_ways(const PairMeshes& pair);
    void list_way(const PairMeshes& pair, const EdgePiece& piece);
    bool goes_with_vertex(const PairMeshes& pair, const EdgePiece& piece);
    void list_way_of_region(const PairMeshes& pair, const EdgePiece& piece);
    void list_way_along(const PairMeshes& pair, const EdgePiece& piece, const Vec3& direction, const WayOut& middle);
    void list_pierced(const PairMeshes& pair, std::uint32_t region);
    static Vec3 point_past(const PairMeshes& pair, const WayOut& way);
    static std::uint32_t edge_past(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way);
    std::uint32_t edge_at(const PairMeshes& pair, const EdgePiece& piece, std::size_t end) const;
    void add(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way);
    void add(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way, std::uint32_t other);
    void leave_out_hidden(std::size_t first);
    void give(std::vector<FeatureContact>& found);

    Loops loops_;
    EdgePieces pieces_;
    Regions regions_;
    std::vector<TouchingVertex> touching_; ///< sorted
    Effort effort_ = Effort::edges_alone;
    std::vector<Candidate> candidates_;
    std::uint32_t number_ = 0;                                      ///< of the next candidate
    std::vector<std::pair<std::uint64_t, const EdgePiece*>> inner_; ///< vertices at ends of pieces
    std::vector<Vec3> asked_;                                       ///< ways, of one region
};

} // namespace raycontact
