// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include <limits>
#include <span>

namespace raycontact {

/// Where a ray meets a mesh, in double and in the centred frame of the mesh.
struct MeshHit {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t face = NONE;
    bool from_inside = false;
};

namespace trees {

/// A mesh's tree, without anything that code for one instruction set must not share with another.
struct Tree {
    const kernels::Node* nodes;
    const kernels::TriangleBlock* blocks;
};

struct Ray {
    double origin[3], direction[3];         ///< direction: unit
    double least, most;                     ///< hits with least < distance <= most count
    double tolerance;                       ///< metres that boxes are looked beyond `most`
    double reach;                           ///< of the mesh: largest distance of a vertex from its centre
    bool from_inside = false;               ///< faces met from outside do not count
    const std::uint32_t* skipped = nullptr; ///< faces that do not count
    std::uint32_t skipped_count = 0;
};

/// The walk over a tree that takes most of the time, compiled for one instruction set. All give the same bits.
struct Walks {
    const char* instruction_set;
    /// The closest face that counts; of equal ones the lowest.
    MeshHit (*closest_hit)(const Tree&, const Ray&);
};

/// Those that this processor can run, the widest first.
std::span<const Walks* const> usable_walks();

} // namespace trees
} // namespace raycontact
