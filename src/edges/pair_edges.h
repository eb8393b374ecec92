// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/crossings.h"
#include "edges/feature_contact.h"
#include "mesh/disjoint_sets.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// The edges' rule for one pair (docs/edges.md). Keeps nothing but memory from one pair to the next.
class PairEdges {
public:
    /// placed: a in b, b in a. near: the edges that could cross. vertices: the vertex contacts of a, of b.
    /// Adds contacts in any order; returns whether any edge crosses a face.
    bool find(const std::array<SourceMesh, 2>& placed, const NearEdges& near,
              const std::array<std::span<const kernels::LocalContact>, 2>& vertices,
              std::vector<FeatureContact>& found);

private:
    /// A vertex in contact.
    struct VertexContact {
        std::uint32_t vertex;
        std::uint32_t face; ///< of the target, that its ray met
        double depth;
        Vec3 point;
        std::uint32_t region; ///< its number among all, later of its region
    };
    /// An end of a piece: a crossing, or a vertex of the source inside the target.
    struct End {
        Vec3 point; ///< pulled a little into the piece
        std::uint32_t vertex = NONE;
        std::uint32_t crossing = 0; ///< Contact::crossing
        const VertexContact* vertex_contact = nullptr;
        bool is_crossing() const { return vertex == NONE; }
    };
    /// A piece of an edge inside the target.
    struct Piece {
        std::uint32_t edge;
        std::uint32_t region; ///< the number of one of its crossings among all, later of its region
        std::array<End, 2> ends;
        std::array<std::uint32_t, 2> faces; ///< crossed at either end, NONE at a vertex
    };
    /// A face by which a piece may leave the target.
    struct Candidate {
        std::uint32_t face;
        Vec3 normal;
        double height;                ///< of its plane
        std::array<double, 2> depths; ///< of both ends of the piece
        double deeper() const { return depths[0] > depths[1] ? depths[0] : depths[1]; }
    };
    /// The face by which a piece gives contacts.
    struct Choice {
        const Piece* piece;
        Candidate by;
        double metres; ///< that the region must move to leave by it
    };
    struct RegionPoint {
        std::uint32_t region;
        std::uint32_t number; ///< among all
        Vec3 point;
    };
    /// A crossing on the line in which a flat face of either body meet.
    struct OnCurve {
        std::uint64_t faces; ///< of a in the upper half, of b in the lower
        double at;           ///< along the line
        std::uint32_t node;  ///< the crossing's number among all
        Vec3 point;          ///< frame of b
    };
    /// How far a region must move to leave the target by a face's plane.
    struct Extent {
        std::uint32_t region;
        Vec3 normal;
        double height; ///< of the plane
        double metres;
        std::uint32_t next; ///< the extent of that region found before, or NONE
    };

    /// concave: whether concave edges have pieces, too.
    void ask(const std::array<SourceMesh, 2>& placed,
             const std::array<std::span<const kernels::LocalContact>, 2>& vertices, bool concave,
             std::vector<FeatureContact>& found);
    static void list_vertices(const SourceMesh& placed, std::span<const kernels::LocalContact> vertices,
                              std::uint32_t& node, std::vector<VertexContact>& in_contact);
    static void list_pieces(const SourceMesh& placed, std::span<const Crossing> crossings,
                            std::span<const VertexContact> in_contact, std::uint32_t first_node, bool concave,
                            std::vector<Piece>& pieces);
    void list_curves(const std::array<SourceMesh, 2>& placed, std::size_t side, std::uint32_t first_node);
    void join_curves(const SourceMesh& a_in_b);
    void join_vertices(const SourceMesh& placed, std::size_t side);
    void give_contacts(const SourceMesh& placed, std::size_t side, std::vector<FeatureContact>& found);
    static Candidate candidate_of(const SourceMesh& placed, const Piece& piece, std::uint32_t face);
    void choose(const SourceMesh& placed, const Piece& piece);
    void agree(const SourceMesh& placed, std::span<Choice> region);
    void give_contacts(const ShapeData& target, VertexBody source, const Choice& choice,
                       std::vector<FeatureContact>& found);
    double extent(const SourceMesh& placed, std::uint32_t region, const Vec3& normal, double height, double enough);
    /// The deepest vertex contact of this side in a region; null: none.
    const VertexContact* deepest_vertex(std::uint32_t region) const;
    double vertex_depth(std::uint32_t region) const {
        const VertexContact* vertex_contact = deepest_vertex(region);
        return vertex_contact ? vertex_contact->depth : 0;
    }

    std::array<std::vector<Crossing>, 2> crossings_;
    std::array<std::vector<VertexContact>, 2> vertices_; ///< by vertex
    std::array<std::vector<Piece>, 2> pieces_;
    DisjointSets regions_;            ///< crossings and vertices that belong together
    std::vector<OnCurve> curves_;     ///< of both sides
    std::vector<RegionPoint> points_; ///< of one side, by region
    std::vector<Extent> extents_;
    std::vector<std::uint32_t> last_extent_;                         ///< by the first of a region's points_, or NONE
    std::vector<std::pair<std::uint32_t, std::uint32_t>> at_vertex_; ///< of one side: vertex, node
    std::vector<std::pair<std::uint32_t, std::uint32_t>> crossed_;   ///< of one side: edges, by their vertices
    std::vector<std::pair<std::uint32_t, FeatureContact>>
        edge_contacts_;                         ///< of one side: contacts of edges at vertices
    std::vector<const VertexContact*> deepest_; ///< of one side: by region, the deepest first
    std::vector<Choice> choices_;               ///< of one side
};

} // namespace raycontact
