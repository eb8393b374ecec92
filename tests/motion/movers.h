// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/stacks/stack.h>

#include <string>
#include <vector>

namespace raycontact::scenes {

/// A body of 0.2 to 0.4 m that moves.
struct Mover {
    std::string name;
    StackShape shape;
    double low = 0; ///< metres from its origin down to the ground when it stands
};

Mover box();
Mover plate();           ///< 5 mm thick
Mover cylinder();        ///< upright, 24 sides
Mover hull();            ///< a frustum of seven sides
Mover ball_mesh();       ///< 24 by 13 sides, stands on one
Mover capsule_mesh();    ///< likewise, lies along x
Mover pebble();          ///< 5 000 triangles, flat below
Mover mug_on_its_foot(); ///< concave, 1 700 triangles
// Shapes of Bullet's own for every finder.
Mover bullet_box();
Mover bullet_cylinder();
Mover bullet_hull();
Mover bullet_ball();
Mover bullet_capsule();
Mover compound();           ///< a table of five btBoxShapes
Mover compound_of_meshes(); ///< the same of btGImpactMeshShapes

std::vector<Mover> all_movers();

} // namespace raycontact::scenes
