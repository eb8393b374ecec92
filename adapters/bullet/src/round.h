// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <surface.h>

#include <LinearMath/btTransform.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raycontact::bullet {

/// A ball, or a capsule: all points within a radius of a segment. In the shape's frame, metres.
struct Round {
    Vec3 ends[2];
    int balls = 1; ///< 1: both ends are the same
    double radius = 0;
};

/// `shape` is of kind round.
Round round_of(const btCollisionShape& shape);
/// Its longest way through, metres.
double size_of(const Round& round);

/// What a ball or capsule may meet.
struct Obstacle {
    Surface surface;
    btTransform pose, next; ///< in the world, rigid; next: where it is expected at the next dispatch
    bool two_sided = false; ///< it stops the round on the side where its centre is, whatever the winding
    double margin = 0;      ///< metres; a step lower than this is no wall
};

/// Where a ball or capsule is nearest to an obstacle, or will touch it. World frame.
struct RoundContact {
    std::size_t obstacle = 0;   ///< its index
    int place = 0;              ///< names it from step to step: which end, or the side; of several the how manyth
    btVector3 point;            ///< on the obstacle
    btVector3 normal;           ///< unit, out of the obstacle, or towards the side where it is pushed
    btScalar distance{};        ///< negative: the depth
    std::uint32_t triangle = 0; ///< of the mesh, index of its file
    PlaceName name{};           ///< on a height field
};

/// Of each obstacle, the places where the distance of an end, or that of a capsule's side from edges and corners, is a
/// local minimum of at most `reach` from the surface: the direction lies in the normal cone of what is there. The
/// obstacles are one surface: no edge counts where another facet goes on towards the round, of whatever mesh, less than
/// the margin beside or below it. An end with its centre inside has one contact with that obstacle, the nearest way
/// out, however deep it is in a closed mesh; so has a capsule's axis for each piece of it that is inside between its
/// ends. In closed form: a ball rolls without facets.
///
/// next: where it is expected at the next dispatch. With it, what is near and would be passed counts only if it is
/// touched on the straight way there, as it is then; and all that is touched counts, as far as it goes on along what it
/// touched first. The distance is that from the plane of the touch.
///
/// Sorted by obstacle.
void round_contacts(const Round& round, const btTransform& pose, const std::optional<btTransform>& next,
                    std::span<const Obstacle> obstacles, double reach, std::vector<RoundContact>& out);

} // namespace raycontact::bullet
