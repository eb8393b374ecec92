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

/// Every vertex of the mesh below the plane, ascending; `normal` becomes the plane's unit normal in the world frame.
void plane_contacts(const Converted& mesh, const btTransform& mesh_pose, const btStaticPlaneShape& plane,
                    const btTransform& plane_pose, btVector3& normal, std::vector<PlaneContact>& out);

} // namespace raycontact::bullet
