// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/near_edges.h"
#include "speculative/approach.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// The speculative contacts of the vertices of a pair (docs/internals/speculative.md).
class VertexSearch {
public:
    /// Adds them in any order. near: vertices and the faces that they may come near, each vertex's together.
    /// touching: of a's vertices, of b's, those in contact, by rising vertex.
    void find(const SpeculativePair& pair, const NearEdges& near,
              const std::array<std::span<const kernels::LocalContact>, 2>& touching,
              std::vector<FeatureContact>& found);

private:
    /// A vertex that meets the target, though another part of its body is there first.
    struct Follower {
        std::uint32_t vertex;
        Vec3 point;
        Approach approach;
    };
    void find(const SpeculativePair& pair, Side side, std::uint32_t vertex, std::span<const NearEdge> faces,
              const kernels::LocalContact* touches, std::vector<FeatureContact>& found);
    void add_followers(const ShapeData& source, Side side, std::uint32_t vertex, const Vec3& normal,
                       std::vector<FeatureContact>& found);

    std::vector<Approach> approaches_; ///< of one vertex
    std::vector<Follower> followers_;  ///< of one body
};

} // namespace raycontact
