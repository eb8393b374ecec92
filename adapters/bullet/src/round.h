// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>

#include <LinearMath/btTransform.h>

#include <cstdint>
#include <vector>

namespace raycontact::bullet {

/// A ball, or a capsule: all points within a radius of a segment. In the shape's frame.
struct Round {
    btVector3 ends[2];
    int balls = 1; ///< 1: both ends are the same
    btScalar radius{};
    bool two_sided = false; ///< an open mesh stops it on the side where its centre is, whatever the winding
};

/// `shape` is of kind round.
Round round_of(const btCollisionShape& shape);

/// Where a ball or capsule is nearest to a mesh. World frame.
struct RoundContact {
    int place = 0;              ///< names it from step to step: which end, or the side; of several the how manyth
    btVector3 point;            ///< on the mesh
    btVector3 normal;           ///< unit, out of the mesh, or towards the side where it is pushed
    btScalar distance{};        ///< negative: the depth
    std::uint32_t triangle = 0; ///< of the shape
};

/// Places where the distance of an end from the mesh, or that of a capsule's side from the mesh's edges and corners, is
/// a local minimum of at most `reach` from the surface. An end with its centre inside has one contact, the nearest way
/// out, however deep it is in a closed mesh; so has a capsule's axis for each piece of it that is inside between its
/// ends. In closed form: a ball rolls without facets.
void round_contacts(const Converted& mesh, const btTransform& mesh_pose, const Round& round,
                    const btTransform& round_pose, btScalar reach, std::vector<RoundContact>& out);

/// Adds where a ball or capsule first meets a mesh which it does not touch yet, on the straight way to where both are
/// expected next, as the mesh sees it; where a capsule's ends do, too. The distance is that from the plane of the
/// touch. What is met at a glancing angle, as the floor that a ball rolls on, does not count.
void first_touches(const Converted& mesh, const btTransform& mesh_pose, const btTransform& mesh_next,
                   const Round& round, const btTransform& round_pose, const btTransform& round_next,
                   std::vector<RoundContact>& out);

} // namespace raycontact::bullet
