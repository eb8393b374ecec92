// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace raycontact::bullet {

/// A vertex below a plane, or near to it.
struct PlaneContact {
    std::uint32_t vertex; ///< of the shape
    btVector3 point;      ///< the vertex, world
    btScalar depth;       ///< along the plane's normal, metres; <= 0: it is above
};

/// All points p with normal . p <= height. World frame.
struct HalfSpace {
    btVector3 normal; ///< unit
    double height = 0;
};
HalfSpace half_space(const btStaticPlaneShape& plane, const btTransform& plane_pose,
                     const Stretch& stretch = no_stretch);

/// The plane of the one face of a box that a mesh can meet: the mesh, or its turned local box, lies over that face
/// without reaching a rim, and reaches below it but not to the opposite face or the middle. No edge of the box is near,
/// so all there is of contact is vertices of the mesh below that plane: those that the batch finds, for less.
std::optional<HalfSpace> only_face(const Converted& mesh, const btTransform& mesh_pose, const btBoxShape& box,
                                   const btTransform& box_pose);

/// How far a point is below the surface, metres.
double depth_in(const HalfSpace& space, const Vec3& point);

/// Every vertex of the mesh that is in the half space, or nearer to it than `reach`, ascending.
void plane_contacts(const Converted& mesh, const btTransform& mesh_pose, const HalfSpace& space, btScalar reach,
                    std::vector<PlaneContact>& out);

} // namespace raycontact::bullet
