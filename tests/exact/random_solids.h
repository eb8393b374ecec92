// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

#include <raycontact/mesh.h>

// Closed meshes of one piece without self-intersections, stretched and scaled at random, from 0.01 to 2 m.
namespace raycontact::exact {

/// 4 to 200 triangles: tetrahedron, box, bar, plate, prism, cone, flat and spiked star, gear, frame, torus, L, ...
Mesh coarse_solid(reference::Random& random);
/// 300 to 1500 triangles: torus, bumpy sphere, knot, gear, star.
Mesh fine_solid(reference::Random& random);

// Its parts, for cases by hand. The axis is z, the middle at the origin.
Mesh prism_solid(std::uint32_t corners, double radius, double half_height);
Mesh cone_solid(std::uint32_t corners, double radius, double height); ///< base at z = 0, apex above it

} // namespace raycontact::exact
