// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/block_bounds.h"

#include <limits>
#include <span>

namespace raycontact {

/// Where a ray meets a mesh, in double and in the centred frame of the mesh.
struct MeshHit {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t face = NONE;
    bool from_inside = false;
};

/// A triangle of the first body and one of the second.
struct TrianglePair {
    std::uint32_t first, second;
};

namespace trees {

/// A mesh's tree, without anything that code for one instruction set must not share with another.
struct Tree {
    const kernels::Node* nodes;
    const kernels::TriangleBlock* blocks;
    const BlockBounds* bounds; ///< of the blocks
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

/// Two trees, the pose of the first in the frame of the second, and where the pairs go.
struct TwoTrees {
    Tree first, second;
    float rotation[9], translation[3];
    float span;          ///< pairs of triangles neither of which has a longer BlockBounds::span are left out; metres
    float apart;         ///< triangles that a plane or a box shows to be farther apart than this are left out; metres
    TrianglePair* pairs; ///< a buffer, and what to do when it is full
    std::uint32_t room;
    void* list;
    void (*flush)(void* list, const TrianglePair* pairs, std::uint32_t count);
};

/// The walks over the trees that take most of the time, compiled for one instruction set. All give the same bits.
struct Walks {
    const char* instruction_set;
    /// The closest face that counts; of equal ones the lowest.
    MeshHit (*closest_hit)(const Tree&, const Ray&);
    void (*near_triangles)(TwoTrees&);
};

/// Those that this processor can run, the widest first.
std::span<const Walks* const> usable_walks();

} // namespace trees
} // namespace raycontact
