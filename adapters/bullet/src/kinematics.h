// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <LinearMath/btTransform.h>

#include <cstdint>
#include <optional>
#include <unordered_map>

class btBroadphaseInterface;
class btCollisionObject;
class btCollisionWorld;
class btDispatcher;
class btOverlappingPairCache;

namespace raycontact::bullet {

/// Where kinematic objects will be at the next dispatch: on with the velocity that Bullet's solver takes them to have.
class Kinematics {
public:
    /// First in a dispatch. seconds: until the next one; 0: nothing is expected.
    void begin(std::uint64_t dispatch, btScalar seconds) {
        dispatch_ = dispatch;
        seconds_ = seconds;
        if (dispatch % 64 == 0)
            std::erase_if(motions_, [&](const auto& m) { return m.second.dispatch + 2 < dispatch; });
    }
    void forget() { motions_.clear(); }
    /// Empty where the object is not kinematic, does not move, or was put elsewhere: it went farther than its own size,
    /// unlike in its motion before.
    std::optional<btTransform> next_of(const btCollisionObject& object);
    /// Gives what moves a box in the broad phase that holds its way, as Bullet does for dynamic bodies alone. Bullet's
    /// next update of the boxes takes it back. So the pairs on the way are Bullet's own, with its filters and
    /// lifetimes.
    void sweep(btCollisionWorld& world, btDispatcher* dispatcher);

private:
    /// Of one object that moves.
    struct Motion {
        btTransform pose;
        btVector3 velocity, spin;
        std::uint64_t dispatch = 0; ///< that looked last
        int stay = 0;               ///< number of its broad-phase proxy: another object may get its address
        bool is_believed = false;
    };

    std::unordered_map<const btCollisionObject*, Motion> motions_; ///< no order of it shows
    std::uint64_t dispatch_ = 0;
    btScalar seconds_ = 0;
};

} // namespace raycontact::bullet
