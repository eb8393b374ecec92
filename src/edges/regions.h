// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/edge_pieces.h"
#include "mesh/disjoint_sets.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// A vertex of the pair whose ray found a contact.
struct TouchingVertex {
    std::uint64_t vertex; ///< see vertex_of_side()
    double depth;         ///< metres
    std::uint32_t face;   ///< of the other body

    std::size_t side() const { return vertex >> 32; }
    std::uint32_t number() const { return static_cast<std::uint32_t>(vertex); }
};

/// Loops, pieces and vertices in contact that hang together.
struct Region {
    Vec3 area;           ///< the sum of its loops', m^2
    double area_sum = 0; ///< of their lengths
    double deepest = 0;  ///< contact so far, metres
    Vec3 normal;         ///< of that contact, the way in which a leaves b
    bool speaks = false; ///< it has a contact
    bool leads = true;   ///< the area says which way is out: of two sheets, which enclose nothing, it does not

    /// Its loops nearly cancel: a body is pierced through.
    bool is_pierced() const { return leads && !(length(area) > 0.25 * area_sum); }
    void tell(double depth, const Vec3& way) {
        speaks = true;
        if (!(depth > deepest)) return;
        deepest = depth;
        normal = way;
    }
};

/// Finds what hangs together, for one pair after the other. Keeps nothing but memory.
class Regions {
public:
    /// touching: sorted.
    void find(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces,
              std::span<const TouchingVertex> touching);
    std::span<Region> all() { return regions_; }
    std::uint32_t of_crossing(std::uint32_t crossing) const { return region_of_[crossing]; }

private:
    void join(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces);
    void join_vertices(const PairMeshes& pair, const EdgePieces& pieces);
    std::uint32_t node_of(const TouchingVertex& v) const {
        return first_vertex_ + static_cast<std::uint32_t>(&v - touching_.data());
    }

    std::span<const TouchingVertex> touching_;
    std::uint32_t first_vertex_ = 0; ///< nodes: the crossings, the vertices in contact, other ones at ends of pieces
    std::vector<std::pair<std::uint64_t, std::uint32_t>> ends_; ///< of pieces: vertex, crossing; sorted
    std::array<std::vector<std::uint32_t>, 2> node_at_;         ///< by vertex of either body; NONE between pairs
    DisjointSets sets_;                                         ///< of nodes
    std::vector<std::uint32_t> region_of_;                      ///< by node
    std::vector<Region> regions_;
};

} // namespace raycontact
