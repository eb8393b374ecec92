// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/edge_pieces.h"
#include "mesh/disjoint_sets.h"

#include <array>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace raycontact {

/// A face of one body of a pair, of which some lies inside the other. Frame of PairMeshes.
struct InnerFace {
    std::uint32_t face;
    std::uint32_t part;   ///< a piece of its side's surface that is convex as a whole; those of a come first
    std::uint32_t region; ///< what hangs together at all, over both sides
    Vec3 normal;          ///< outward, unit
    double area = 0;      ///< of what lies inside, m^2
    Vec3 middle;          ///< of that
    std::uint32_t first_segment = 0, segment_count = 0; ///< its outline; none: all of the face
};

/// A directed part of the outline of what of a face lies inside, which is to its left as seen from outside.
using OutlineSegment = std::array<Vec3, 2>;

/// What of the surfaces of two closed bodies lies inside the other, as far as it hangs together with the loops in which
/// they cross. Keeps nothing but memory from one pair to the next.
class InnerSurfaces {
public:
    /// loops: all of the pair's, closed. pieces: of their crossings.
    void find(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces);
    /// Sorted by their faces.
    std::span<const InnerFace> of(std::size_t side) const { return faces_[side]; }
    /// Null: none of it lies inside.
    const InnerFace* at(std::size_t side, std::uint32_t face) const;
    std::span<const OutlineSegment> outline(const InnerFace& face) const {
        return std::span(segments_).subspan(face.first_segment, face.segment_count);
    }
    std::uint32_t first_part(std::size_t side) const { return side == 0 ? 0 : parts_of_a_; }
    std::uint32_t end_part(std::size_t side) const { return side == 0 ? parts_of_a_ : parts_; }

private:
    /// What the loops say about one side.
    struct Side {
        std::unordered_map<std::uint32_t, bool> inside;            ///< by vertex, of those that are known
        std::vector<std::pair<std::uint32_t, OutlineSegment>> cut; ///< by face: along the loops
        std::vector<std::uint32_t> open;                           ///< faces to be looked at
        std::unordered_set<std::uint32_t> seen;
    };
    /// Two faces of one side that share an edge, of which some is inside.
    struct Joint {
        std::size_t side;
        std::array<std::uint32_t, 2> faces;
        bool flush, convex;
    };
    void begin(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces, std::size_t side);
    void visit(const PairMeshes& pair, const EdgePieces& pieces, std::size_t side, std::uint32_t face);
    void know_corners(const PairMeshes& pair, const EdgePieces& pieces, std::size_t side, std::uint32_t face);
    void join_regions(const Loops& loops);
    void divide(double size);
    std::uint32_t node_at(std::size_t side, std::uint32_t face) const;
    InnerFace& face_of(std::uint32_t node) {
        return node < faces_[0].size() ? faces_[0][node] : faces_[1][node - faces_[0].size()];
    }

    std::array<Side, 2> sides_;
    std::array<std::vector<InnerFace>, 2> faces_;
    std::vector<OutlineSegment> segments_;
    std::vector<Joint> joints_;
    DisjointSets sets_;
    std::uint32_t parts_ = 0, parts_of_a_ = 0;
};

} // namespace raycontact
