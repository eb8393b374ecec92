// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "round/facets.h"

#include <array>
#include <vector>

namespace raycontact {

/// How far a capsule's axis has to move, and along what, to be out of a mesh. Frame of the surface.
struct AxisExit {
    Vec3 point;       ///< on the mesh
    Vec3 normal;      ///< unit, out of the mesh
    double depth = 0; ///< metres, >= 0
    Facet facet;      ///< that the point lies on
};

/// An axis that runs through a mesh while its ends do not tell: one exit for each of its pieces inside, the shortest
/// of those along the faces where it enters and leaves and those past an edge beside it. `known[k]`: what is behind the
/// surface at end k has its contact already, as always with a closed mesh.
void ways_out(const Facets& mesh, const Vec3& a, const Vec3& b, const std::array<bool, 2>& known,
              std::vector<AxisExit>& out);
/// The same for an open mesh whose faces stop it on both sides: at each face that the axis runs through, to the side
/// where more of it is.
void ways_through(const Facets& mesh, const Vec3& a, const Vec3& b, std::vector<AxisExit>& out);

} // namespace raycontact
