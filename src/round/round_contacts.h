// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "round/facets.h"

#include <raycontact/pose.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// What a ball or capsule may meet.
struct Obstacle {
    Facets surface;
    Pose pose, next;        ///< in the world, rigid; next: where it is expected in the next step
    bool two_sided = false; ///< it stops the round on the side where its centre is, whatever the winding
    double margin = 0;      ///< metres; a step lower than this is no wall
};

/// Where a ball or capsule is nearest to an obstacle, or will touch it. World frame.
struct RoundContact {
    std::size_t obstacle = 0;        ///< its index
    int place = 0;                   ///< names it from step to step: place_of()
    bool is_later = false;           ///< it touches on the way; distance: from the plane of that touch
    Vec3 point;                      ///< on the obstacle
    Vec3 normal;                     ///< unit, out of the obstacle, or towards the side where it is pushed
    double distance = 0;             ///< negative: the depth
    std::uint32_t triangle = 0;      ///< of the mesh, index of its file
    std::array<int, 2> name{-1, -1}; ///< of a facet that is no mesh's
};

/// Names a place of a round: which end (0, 1) or the side (2), and on which of 26 sides of the obstacle it is, by the
/// normal in the obstacle's frame, and the how manyth of those: whatever else is touched, it stays.
int place_of(int part, const Vec3& normal, int number);
/// Added to the places of what touches later, but for what was near already.
inline constexpr int coming = 1 << 20;

/// Of each obstacle, the places where the distance of an end, or that of a capsule's side from edges and corners, is a
/// local minimum of at most `reach` from the surface: the direction lies in the normal cone of what is there. The
/// obstacles are one surface: no edge counts where another facet goes on towards the round, of whatever mesh, less than
/// the margin beside or below it. An end with its centre inside has one contact with that obstacle, the nearest way
/// out, however deep it is in a closed mesh; so has a capsule's axis for each piece of it that is inside between its
/// ends. In closed form: a ball rolls without facets.
///
/// next: where it is expected in the next step. With it, what is near and would be passed counts only if it is
/// touched on the straight way there, as it is then; and all that is touched counts, as far as it goes on along what it
/// touched first. The distance is that from the plane of the touch.
///
/// Sorted by obstacle.
RAYCONTACT_API void round_contacts(const Round& round, const Pose& pose, const std::optional<Pose>& next,
                                   std::span<const Obstacle> obstacles, double reach, std::vector<RoundContact>& out);

} // namespace raycontact
