// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <candidate.h>
#include <convert.h>

#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <cstdint>
#include <vector>

namespace raycontact::bullet {

/// A vertex below a plane.
struct PlaneContact {
    std::uint32_t vertex; ///< of the shape
    btVector3 point;      ///< the vertex, world
    btScalar depth;       ///< > 0, along the plane's normal, metres
};

/// All points p with normal . p <= height. World frame.
struct HalfSpace {
    btVector3 normal; ///< unit
    double height = 0;
};
HalfSpace half_space(const btStaticPlaneShape& plane, const btTransform& plane_pose,
                     const Stretch& stretch = no_stretch);

/// Every vertex of the mesh within the half space, ascending.
void plane_contacts(const Converted& mesh, const btTransform& mesh_pose, const HalfSpace& space,
                    std::vector<PlaneContact>& out);

} // namespace raycontact::bullet
