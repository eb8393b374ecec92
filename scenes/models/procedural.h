// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>

namespace raycontact::scenes {

// Closed meshes, concave but for the round sphere, of an exact, even number of triangles; +, -, *, / and square roots
// only, so that every compiler gives the same bits. Scaled and centred by normalise(). Each throws InputError for a
// count it cannot have.

Mesh bumpy_sphere(std::uint32_t triangles); ///< even, from 8; concave from about 60
Mesh round_sphere(std::uint32_t triangles); ///< even, from 8; vertices at distance 1 before normalise()
Mesh star(std::uint32_t triangles);         ///< even, from 400; six rounded arms along the axes
Mesh hare(std::uint32_t triangles);         ///< even, from 400; it sits, looks along x, its ears along y
Mesh bumpy_torus(std::uint32_t triangles);  ///< even, from 18
Mesh gear(std::uint32_t triangles);         ///< even, from 48; a spur gear with a bore, more teeth with more triangles
Mesh knot(std::uint32_t triangles);         ///< even, from 60; a tube around the (2,3) torus knot

/// Largest box extent 1 m, centre of volume at the origin, coordinates rounded to float32. The mesh must be closed.
void normalise(Mesh& mesh);

} // namespace raycontact::scenes
