// SPDX-License-Identifier: Apache-2.0
#include "reference/exits.h"
#include "reference/solid.h"

namespace raycontact::reference {

Solid make_surface(const Shape& shape) {
    Solid solid = make_surface(shape.name(), {shape.vertices().begin(), shape.vertices().end()},
                               {shape.triangles().begin(), shape.triangles().end()}, shape.centre());
    solid.vertex_index.assign(shape.vertex_index().begin(), shape.vertex_index().end());
    solid.triangle_index.assign(shape.triangle_index().begin(), shape.triangle_index().end());
    return solid;
}

Solid make_solid(const Shape& shape) {
    Solid solid = make_surface(shape);
    add_exits(solid);
    return solid;
}

} // namespace raycontact::reference
