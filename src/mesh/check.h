// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/adjacency.h"

#include <cstdint>
#include <span>

namespace raycontact {

/// How triangles hang together, as MeshReport says it.
struct Topology {
    bool closed = true, manifold = true, oriented = true;
    std::uint64_t components = 0;
};

/// Every vertex below vertex_count is in use by a triangle.
Topology check_topology(std::span<const Triangle> triangles, std::span<const HalfEdge> edges,
                        std::uint32_t vertex_count);

} // namespace raycontact
