// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/loops.h"
#include "mesh/disjoint_sets.h"
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
    struct VertexContact {
        std::uint64_t vertex; ///< side in the upper half
        double depth;
        std::size_t side() const { return vertex >> 32; }
        std::uint32_t number() const { return static_cast<std::uint32_t>(vertex); }
    };
    /// A part of an edge inside the other body, from a crossing or the edge's end to the next.
    struct Piece {
        std::uint32_t side, edge;
        std::array<std::uint32_t, 2> crossings; ///< at its ends; NONE: it ends at a vertex there
        std::array<Vec3, 2> ends;
        bool is_through() const { return crossings[0] != NONE && crossings[1] != NONE; }
    };
    /// Two edges that pass each other.
    struct Passing {
        std::uint32_t region;
        FeatureContact contact;
    };
    /// Loops, pieces and vertices that hang together: they leave in one way.
    struct Region {
        Vec3 area;                                ///< the sum of its loops'
        double area_sum = 0;                      ///< of their lengths
        double loop_length = 0, flush_length = 0; ///< of its loops; of them between faces that look nearly the same way
        double deepest = 0;                       ///< of its vertices in contact
        double told = 0;                          ///< the deepest contact so far
        bool speaks = false;                      ///< it has a contact
        std::uint32_t first_point = 0, end_point = 0;
        std::uint32_t first_face = 0, end_face = 0;
        Vec3 way; ///< in which a leaves b, once asked
        /// Rounding draws a part of its loops that counts.
        bool is_flush() const { return flush_length > 0.1 * loop_length; }
        /// Its loops nearly cancel: a body is pierced through.
        bool is_pierced() const { return !(length(area) > 0.25 * area_sum); }
    };
    struct Range {
        double low, high;
        double extent() const { return high - low; }
        void add(double at) {
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
    };

    void list_vertices(const std::array<std::span<const kernels::LocalContact>, 2>& vertices);
    void list_pieces(const PairMeshes& pair);
    void join_regions(const PairMeshes& pair);
    void join_vertices(const PairMeshes& pair);
    void sort_by_region(std::vector<std::pair<std::uint32_t, Vec3>>& list);
    void list_regions(const PairMeshes& pair);
    void pass_edges(const PairMeshes& pair);
    void pass(const PairMeshes& pair, const Loop& loop, std::uint32_t of_a, std::uint32_t of_b);
    void give_edges(std::vector<FeatureContact>& found);
    const Vec3& way_of(const PairMeshes& pair, Region& region) const;
    Vec3 find_way(const PairMeshes& pair, const Region& region) const;
    bool is_thinner(const Region& region, double limit) const;
    Range range(const Region& region, const Vec3& normal) const;
    static MeshHit exit_along(const PairMeshes& pair, const Piece& piece, const Vec3& point, const Vec3& way);
    void add_deep(const PairMeshes& pair, const Piece& piece, const Vec3& point, const Vec3& way, double depth,
                  const MeshHit& hit);
    void list_deep(const PairMeshes& pair, std::uint32_t region);
    void list_pierced(const PairMeshes& pair, std::uint32_t region);
    void give_deep(const PairMeshes& pair, std::vector<FeatureContact>& found);
    std::uint32_t node_of(const VertexContact& c) const {
        return static_cast<std::uint32_t>(crossings().size() + std::size_t(&c - in_contact_.data()));
    }
    bool speaks(const PairMeshes& pair, const Piece& piece) const;
    std::span<const Crossing> crossings() const { return loops_.crossings(); }
    std::uint32_t region_of(const Piece& piece) const {
        return region_of_[piece.crossings[0] == NONE ? piece.crossings[1] : piece.crossings[0]];
    }
    void follow_loops(const PairMeshes& pair, const NearEdges& near);

    Loops loops_;
    std::vector<std::uint32_t> by_edge_;    ///< crossings, those of an edge along it
    std::vector<VertexContact> in_contact_; ///< by vertex
    bool all_speak_ = false;
    std::vector<Piece> pieces_;                 ///< as their edges are numbered, and along these
    std::vector<std::uint64_t> other_vertices_; ///< at ends of pieces, not in contact
    std::size_t node_count_ = 0;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> piece_vertices_; ///< vertex, crossing
    std::vector<std::array<std::uint64_t, 2>> crossed_;                   ///< edges that are, by their vertices; sorted
    std::array<std::vector<std::uint32_t>, 2> node_at_; ///< by vertex of either body; NONE between pairs
    DisjointSets sets_;                                 ///< crossings, then vertices_
    std::vector<std::uint32_t> region_of_;              ///< by crossing and vertex
    std::vector<Region> regions_;
    std::vector<std::pair<std::uint32_t, Vec3>> points_, faces_; ///< by region: points, and normals of faces crossed
    std::vector<std::pair<std::uint32_t, Vec3>> sorted_;
    std::vector<std::uint32_t> firsts_; ///< by region
    std::vector<Passing> passing_;
    std::vector<FeatureContact> deep_; ///< of one region
    std::vector<Vec3> asked_;          ///< ways, of one region
};

} // namespace raycontact
