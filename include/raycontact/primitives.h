// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>
#include <raycontact/export.h>
#include <raycontact/mass.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <memory>
#include <span>

// Shapes by their measures. Body frame, metres.
//
// Balls and capsules are round (Shape::round()): queries (query.h, separation.h) and contacts take them as what they
// are, to rounding; in answers of queries their triangles are Shape::no_triangle. A ray that touches one meets it.
// Their contacts (FeatureKind::round) are those of every method, on the host: a ball rolls on a mesh without feeling
// facets or seams, and where meshes lie beside one another they are one surface to it. contact_patches() takes meshes
// alone: it throws InputError for round shapes. The mesh of a round shape is a picture, with vertices on the surface:
// for viewers, files, and the regions of query.h. Its box and radius are those of the body.

namespace raycontact {

/// About the origin. Throws InputError for a radius that is not from 1e-6 to 1e8 m.
RAYCONTACT_API std::shared_ptr<const Shape> make_ball(double radius);

/// All within `radius` of the segment from (0, 0, -half_length) to (0, 0, half_length). Throws InputError for a radius
/// that is not from 1e-6 to 1e8 m, and for a half length that is not from 0 to 1e8 m.
RAYCONTACT_API std::shared_ptr<const Shape> make_capsule(double radius, double half_length);

/// Of a ball or capsule, by closed formulas: its mesh holds less.
RAYCONTACT_API Mass mass_of(const Round& round);

/// Of 12 triangles, exactly, from -half to half. Throws InputError for halves that are not from 1e-6 to 1e8 m.
RAYCONTACT_API std::shared_ptr<const Shape> make_box(const Vec3& half);

/// The ground: a box whose top is z = 0, for queries exactly. It is finite because the broad phase sorts bodies by
/// their boxes; what leaves it at a side falls off. Steps see heights from its middle in float32: their depths are
/// right to 1e-7 of the thickness. That is also what a body may fall through in one step unseen. Throws InputError for
/// measures that are not from 1e-6 to 1e8 m.
RAYCONTACT_API std::shared_ptr<const Shape> make_plane(double half_extent = 1000, double thickness = 10);

/// Places of the samples of a height field, metres.
struct HeightGrid {
    std::uint32_t rows = 0;    ///< along x, two at least
    std::uint32_t columns = 0; ///< along y, two at least
    double step_x = 1;         ///< between rows
    double step_y = 1;         ///< between columns
};

/// The closed solid under a grid of heights, down to a floor, with walls around. heights[i * columns + j] is z at
/// (i * step_x, j * step_y); a cell is two triangles, which share its corners (i, j) and (i + 1, j + 1). floor: z of
/// the bottom, below all heights. Throws InputError for another number of heights, fewer than two rows or columns,
/// heights that are not finite or not above the floor, and steps that are not from 1e-6 to 1e8 m; and as Shape::make().
RAYCONTACT_API std::shared_ptr<const Shape> make_height_field(std::span<const double> heights, const HeightGrid& grid,
                                                              double floor, std::uint32_t threads = 0);

} // namespace raycontact
