// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

#include <raycontact/mesh.h>

#include <array>
#include <string>
#include <vector>

// Parts as people build them: plates and profiles cut from outlines, flush with each other, threads. Metres. Only
// + - * / and square roots, so that every compiler gives the same bits.
namespace raycontact::exact {

using Outline = std::vector<std::array<double, 2>>; ///< counter-clockwise, no three corners in a line

/// A prism over an outline with holes (counter-clockwise, too), its caps cut into ears as files have them.
Mesh extruded(std::string name, const Outline& outline, const std::vector<Outline>& holes, double bottom, double top);

Outline rectangle(double x0, double y0, double x1, double y1);
Outline regular(std::uint32_t corners, double radius, double turn = 0); ///< about the origin; turn in whole turns
/// Corners by turns on two radii, about the origin.
Outline star_outline(std::uint32_t points, double outer, double inner);
/// Teeth with flat tops and flat grounds.
Outline gear_outline(std::uint32_t teeth, double outer, double inner);
Outline l_outline(double width, double height, double thick); ///< its outer corner at the origin
Outline u_outline(double width, double height, double thick); ///< open upwards, its lower left corner at the origin
Outline t_outline(double width, double height, double thick); ///< the stem's foot at the origin
Outline e_outline(double width, double height, double thick); ///< open to the right, lower left corner at the origin
Outline shifted(Outline outline, double x, double y);

/// Two parts in one frame that overlap by `overlap` along x and are flush otherwise: faces of both lie in one plane,
/// and every other exit is longer.
struct FlushPair {
    Mesh a, b;
    double overlap = 0;
};
constexpr std::uint32_t flush_kinds = 8;
FlushPair flush_pair(std::uint32_t kind, double overlap, reference::Random& random);
/// Parts that fit into each other: beside the overlap, faces lie on faces of the other that look the other way.
constexpr std::uint32_t fitted_kinds = 2;
FlushPair fitted_pair(std::uint32_t kind, double overlap, reference::Random& random);

/// Positions turned and moved.
Mesh placed(Mesh mesh, const Pose& pose);
/// Positions as a text file has them: six significant digits.
Mesh with_six_digits(Mesh mesh);
/// Positions as a binary file has them.
Mesh in_float32(Mesh mesh);

/// A trapezoid thread along z, as M20 in units of its radius: pitch 1/4, flanks of 30 degrees. It turns right: a nut
/// that turns by t turns and moves by t pitches keeps its place in the thread.
constexpr double thread_radius = 1, thread_pitch = 0.25;
constexpr std::uint32_t thread_sides = 36;
Mesh bolt_mesh(std::uint32_t pitches);
/// Hexagonal outside. `clearance`: by how much its thread is wider, radially.
Mesh nut_mesh(std::uint32_t pitches, double clearance);

/// A box without a lid: 2 x 2 x 1 outside, walls and floor 0.2 thick, an inner corner at (-0.8, -0.8, 0.2).
Mesh tray_mesh();
/// A tube along z, its middle at the origin.
Mesh pipe_mesh(std::uint32_t sides, double outer, double inner, double length);

} // namespace raycontact::exact
