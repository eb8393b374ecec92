// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/near_triangles.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// An edge of the source that could cross a face of the target.
struct NearEdge {
    std::uint32_t edge; ///< 3 x its lowest triangle + its first corner
    std::uint32_t face;
};

/// Of a pair: the edges of a near b, and those of b near a; each sorted by edge and face.
using NearEdges = std::array<std::span<const NearEdge>, 2>;

/// How far apart a point of a is for its two directions, at most, metres: rotations may be orthonormal to 1e-4 alone,
/// and then what a in b shows is not what b in a shows.
double mismatch(const std::array<SourceMesh, 2>& placed);

/// Finds the near edges of pairs. Keeps nothing but memory.
class NearSearch {
public:
    /// Adds every edge of either body that comes within `margin` metres of a face of the other, and some more, those of
    /// a near b first; returns their number. None near an open target, which has no inside. placed: a in b, b in a.
    std::size_t find(const std::array<SourceMesh, 2>& placed, double margin, std::vector<NearEdge>& found);

private:
    std::vector<TrianglePair> triangles_;
};

} // namespace raycontact
