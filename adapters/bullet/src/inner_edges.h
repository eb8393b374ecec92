// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace raycontact::bullet {

/// Bullet's algorithms take one triangle after another, and let a shape that slides over a mesh meet edges that lie
/// within its surface. Of each point, the normal that the faces beside its triangle allow. mesh: with a converted
/// shape; mesh_is_0: it is the manifold's first body.
void leave_inner_edges(btPersistentManifold& manifold, const Leaf& mesh, bool mesh_is_0);

} // namespace raycontact::bullet
