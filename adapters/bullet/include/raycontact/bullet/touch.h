// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/precision.h>

#include <LinearMath/btVector3.h>

class btCollisionObject;

namespace raycontact::bullet {

/// Two objects that begin or cease to touch: what drives sounds, sparks and damage. They begin when a contact has a
/// depth, or its gap will close before the next dispatch, which the solver is about to prevent. They cease when all
/// their contacts are gone, or farther than a resting body trembles. Sleep changes nothing.
struct Touch {
    const btCollisionObject* object0 = nullptr; ///< as the manifold's bodies; of those that ceased one may be gone
    const btCollisionObject* object1 = nullptr; ///< the other one
    btVector3 point{0, 0, 0};                   ///< where they came nearest, world frame, metres
    btVector3 normal{0, 0, 0};                  ///< unit, from object1 to object0
    btScalar distance{};                        ///< there, metres; negative: the depth
    btScalar speed{}; ///< at which they approached there, before the solver, m/s; 0 once they ceased
};

} // namespace raycontact::bullet
