// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"
#include "reference/solid.h"

#include <raycontact/mesh.h>

namespace raycontact::reference {

// The public API casts rays from vertices only. A tiny triangle is a source of three parallel rays, from its corners
// against its normal; a cloud of them is an open mesh, so most of its rays have no end.

/// What the rays of a cloud go through, besides the target's inside.
enum class Aim {
    anywhere,   ///< uniform origins in the target's box, uniform directions
    features,   ///< through points of edges and through vertices
    silhouettes ///< through points of edges where one face turns towards the ray and the other away
};

/// `count` triangles about `target`, in its body frame relative to its centre. Coordinates are so coarse that float32
/// holds them exactly, so an aimed ray misses its goal by about 1e-7 m: as near as rounding. The target is at most 4 m.
Mesh ray_cloud(const Solid& target, Aim aim, std::uint32_t count, Random& random);

/// One right triangle in the plane z = 0, corner at the origin: three rays along -z.
Mesh needle();

/// The 24 rotations that map axes to axes: exact.
std::vector<Pose> axis_rotations();

} // namespace raycontact::reference
