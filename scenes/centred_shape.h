// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>
#include <raycontact/shape.h>

#include <memory>
#include <optional>

namespace raycontact::scenes {

/// A user's mesh, scaled and moved so that its origin is its centre of mass, as Bullet wants it.
struct CentredShape {
    std::shared_ptr<const Shape> shape;
    Vec3 centre;       ///< of mass, in the mesh's own frame after scaling: what was subtracted, metres
    double extent = 0; ///< the box's longest edge, metres
};

/// `size`: the longest edge of its box becomes this, metres, > 0; without, all is multiplied by `scale`, > 0. The
/// centre of an open mesh, and of one without volume, is that of its box. Throws InputError for a mesh without an area.
CentredShape centred_shape(Mesh mesh, std::optional<double> size, double scale = 1,
                           Nesting nesting = Nesting::as_wound);

} // namespace raycontact::scenes
