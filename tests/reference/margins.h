// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/solid.h"

namespace raycontact::reference {

/// Smallest distance between the part [0, reach] of a ray (unit direction) and the edges of a solid, metres; edges
/// with an end at vertex `skip` are left out. `reach` may be infinite.
double distance_to_edges(const Solid& solid, const Vec3& origin, const Vec3& direction, double reach,
                         std::uint32_t skip = 0xffffffffu);

/// The point of a triangle that is closest to p.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Distance of a point to the closest triangle of a solid, metres; every triangle is looked at.
double distance_to_surface(const Solid& solid, const Vec3& point);

/// Distance of a point to the faces of the box [low, high], metres, from whichever side.
double distance_to_box(const Vec3& low, const Vec3& high, const Vec3& point);

/// How close one ray came to going another way, each relative to the diagonal of the target.
struct Margins {
    double edge = 0;    ///< ray to an edge, up to where it is decided
    double t_max = 0;   ///< hit distance to the exit distance
    double surface = 0; ///< origin to the target's surface
    double bounds = 0;  ///< origin to the target's bounds
    double least() const;
    const char* name_of_least() const;
};

} // namespace raycontact::reference
