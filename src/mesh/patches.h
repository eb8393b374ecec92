// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/adjacency.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// A largest set of triangles connected over edges that have exactly two triangles.
struct Patch {
    std::uint32_t first = 0;  ///< its lowest triangle
    std::uint32_t size = 0;   ///< triangles
    std::uint32_t turned = 0; ///< how many wind against `first`
    bool orientable = true;   ///< false for a Moebius strip
    bool closed = true;       ///< with windings agreeing, every edge is met as often one way as the other
};

struct Patches {
    std::vector<Patch> list;       ///< by their lowest triangle
    std::vector<std::uint32_t> of; ///< patch of each triangle
    std::vector<char> against;     ///< whether a triangle winds against the first of its patch
};

Patches find_patches(std::span<const Triangle> triangles, std::span<const HalfEdge> edges);

} // namespace raycontact
