// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

#include <raycontact/mesh.h>

#include <cstdint>

// Small meshes for tests, without trigonometry: the same bits from every compiler. Outward, about 1 to 2 m.
namespace raycontact::reference {

Mesh box_mesh(const Vec3& half);     ///< 12 triangles
Mesh grid_box_mesh(std::uint32_t n); ///< cube [0, 1]^3, n x n squares a face: exact in float32 for n a power of two
Mesh tetrahedron_mesh();             ///< not regular
Mesh cone_mesh();                    ///< over an octagon: 14 triangles
Mesh l_prism_mesh();                 ///< concave, axis-aligned: 20 triangles
Mesh frame_mesh();                   ///< a square ring, genus 1: 32 triangles
Mesh bumpy_octahedron_mesh(std::uint32_t n); ///< star-shaped, concave: 8 n^2 triangles
Mesh bowl_mesh(std::uint32_t n);  ///< open: a paraboloid over a square of n x n squares, normals outward (down)
Mesh sheet_mesh(std::uint32_t n); ///< open: a wavy square of n x n squares, normals up

Mesh open_box_mesh(std::uint32_t n); ///< open: the grid box without its lid z = 1

/// A crooked fan of six triangles about its apex (vertex 0), closed by a pyramid far below: now and then the
/// angle-weighted normal leaves the cone of its own triangles.
Mesh crooked_pyramid_mesh(Random& random);

/// The positions moved by `by`; a mesh far from its own origin.
Mesh moved(Mesh mesh, const Vec3& by);

} // namespace raycontact::reference
