// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>

#include <optional>

namespace raycontact::bullet {

/// What a convex shape meets first on its way to where it is expected. World frame.
struct CastHit {
    btVector3 point;     ///< of the convex shape, where it is now: the middle of what comes first
    btVector3 normal;    ///< unit, from the mesh to the convex shape
    btScalar distance{}; ///< that the point may go along the normal
    int triangle = 0;    ///< of the mesh, index of its file
};

/// On the straight way from `pose` to `next` of both leaves. Each face counts from both sides. Empty where Bullet's own
/// algorithm sees the surface before it is passed, since the way along the normal is short; edges are not asked.
std::optional<CastHit> cast_hit(const Leaf& convex, const Leaf& mesh);

} // namespace raycontact::bullet
