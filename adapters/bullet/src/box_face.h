// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>
#include <plane.h>

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <optional>

namespace raycontact::bullet {

/// The plane of the one face of a box that a mesh can meet: the mesh, or its turned local box, lies over that face
/// without reaching a rim, and reaches below it but not to the opposite face or the middle. No edge of the box is near,
/// so all there is of contact is vertices of the mesh below that plane: those that the batch finds, for less.
std::optional<HalfSpace> only_face(const Converted& mesh, const btTransform& mesh_pose, const btBoxShape& box,
                                   const btTransform& box_pose);

} // namespace raycontact::bullet
