// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>
#include <raycontact/bullet/dispatcher.h>

namespace raycontact::bullet {

/// A contact in Bullet's terms, not yet part of a manifold. World frame, metres.
struct Candidate {
    PointKey key;
    int triangle = 0;         ///< of the other body, index of its file; 0 on a plane
    btVector3 on0, on1;       ///< the point on either body's surface
    btVector3 normal;         ///< unit, from body 1 to body 0
    btScalar distance{};      ///< negative: the depth
    btScalar reach{};         ///< size of a patch it may join
    PlaceName name0, name1;   ///< only where gContactAddedCallback will be called
    bool speculative = false; ///< nothing touches yet
};

} // namespace raycontact::bullet
