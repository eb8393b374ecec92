// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <vector>

namespace raycontact::bullet {

/// All numbers that the surface of a box, cylinder, cone, hull or multi-sphere depends on, its type among them: equal
/// numbers, equal surfaces.
std::vector<btScalar> surface_numbers(const btCollisionShape& shape);

/// The surface of such a shape as a closed mesh, in the shape's frame: exact for boxes and hulls, within 1e-3 of the
/// longest edge of its box for the others, whose facets lie as far outside of the true surface as inside. It is the
/// surface that was asked for: Bullet counts the margins of boxes and cylinders inwards; those of hulls and cones,
/// which it adds, are left off. Without triangles if the shape is flat.
Mesh stand_in(const btCollisionShape& shape);

} // namespace raycontact::bullet
