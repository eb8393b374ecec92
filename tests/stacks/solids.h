// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

namespace raycontact::scenes {

// Coarse closed meshes, metres, their origin at the centre of mass.

Mesh solid_wedge(const Vec3& size, bool upper);  ///< 8 triangles: half of a box, below or above its x-z diagonal
Mesh solid_tray(const Vec3& size, double thick); ///< 28 triangles: a box without a lid, its walls and floor `thick`

} // namespace raycontact::scenes
