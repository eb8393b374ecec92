// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>

namespace raycontact::scenes {

// Closed, outward meshes, metres. z is their axis.

/// Takes its centre of mass to the origin; returns where it was.
Vec3 centre(Mesh& mesh);

/// A torus about the origin: `radius` of its middle circle, `thick` of its tube.
Mesh smooth_ring(double radius, double thick, std::uint32_t around, std::uint32_t across);
/// A ball of rings and two poles.
Mesh smooth_ball(double radius, std::uint32_t around, std::uint32_t rings);
/// A stone of an arch about the y axis, from one angle to the other (turns, from x towards z), where it lies in it.
Mesh arch_stone(double inner, double outer, double depth, double from, double to);
/// The lower half of a hollow ball about the origin, open above.
Mesh round_bowl(double inner, double outer, std::uint32_t around);
/// From z = -length to 0, its lower end bevelled.
Mesh peg(double radius, double length, double bevel, std::uint32_t around);
/// A round block, its top at z = 0, with a hole whose sides (not corners) are `radius` away from the axis.
Mesh block_with_hole(double radius, double outer, double depth, double floor, std::uint32_t around);
/// A cup with a handle on the side of x; its floor is at z = 0.
Mesh mug(double radius, double height, double wall);
/// A rod along x that begins in z = 0 at x = 0 and has its tip bent up.
Mesh hook(double length, double tip, double thick);
/// About the origin: radii below and above.
Mesh frustum(double below, double above, double height, std::uint32_t around);
/// A step along y, its top at z = 0 for x < 0 and at `rise` for x > 0, `thick` below z = 0.
Mesh step(double size_x, double size_y, double thick, double rise);
/// An axle with two wheels that have a flange each on their inner side, about the origin: a flange's faces are at
/// `flange` and `inner` from the middle, the tread from there to `outer`.
Mesh axle_with_wheels(double radius, double flange_radius, double axle_radius, double flange, double inner,
                      double outer, std::uint32_t around);
/// Spur gear with an involute of 20 degrees; a tooth points along x. z from -width / 2 to width / 2.
Mesh involute_gear(std::uint32_t teeth, double module, double width);

} // namespace raycontact::scenes
