// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/pair_meshes.h"
#include "pairs/near_edges.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// The speculative contacts of one pair (docs/speculative.md): what is nearer than a margin, and what will touch on its
/// way to the next step; found in double among the edges and faces that are near, so the same for every device. Keeps
/// nothing but memory from one pair to the next.
class SpeculativePair {
public:
    /// What is asked.
    struct Question {
        const PlacedBody &a, &b;
        double margin; ///< metres
        bool edges;    ///< two edges can be in contact
        const NearEdges& near;
        const std::array<std::span<const kernels::LocalContact>, 2>& vertices; ///< in contact: of a, of b
    };
    /// Adds contacts in any order. found: those of edges that are in contact.
    void find(const Question& question, std::vector<FeatureContact>& found);

private:
    /// One body as the other sees it, in the other's centred frame.
    struct Side {
        const ShapeData &source, &target;
        Pose now, next;
        bool moves; ///< a point may go farther than the margin until the next step
        VertexBody body;
    };
    struct Edge {
        std::uint32_t number;
        std::array<Vec3, 2> ends, ways; ///< until the next step
    };

    void find_vertices(const Question& question, const Side& side, std::vector<FeatureContact>& found);
    void find_edges(const Question& question, const Side& side, double least_length,
                    std::vector<FeatureContact>& found) const;

    std::vector<std::uint32_t> in_contact_; ///< vertices of a side, sorted
};

} // namespace raycontact
