// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/stacks/stack.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// What bodies move on: fixed bodies, their top about z = 0 and their middle about the origin.
struct Floor {
    std::string name;
    std::vector<StackShape> shapes;
    std::vector<StackBody> bodies;
};

inline constexpr double floor_width = 24; ///< metres, of the square floors

/// A height above x and y, metres.
using Height = std::function<double(double x, double y)>;
/// A sheet of cells, two triangles each, their diagonals by turns. With `thick` metres it is closed: a copy lies below.
Mesh sheet(double size_x, double size_y, std::uint32_t cells_x, std::uint32_t cells_y, double thick,
           const Height& height = {});

Floor closed_floor(std::uint32_t cells_x, std::uint32_t cells_y); ///< a slab, 1 m thick
Floor open_floor(std::uint32_t cells_x, std::uint32_t cells_y);
Floor uneven_floor();       ///< closed, 100 x 100 cells, vertices off the plane by up to 0.01 mm, as scans are
Floor box_floor();          ///< a btBoxShape for every finder
Floor plane_floor();        ///< a btStaticPlaneShape
Floor height_field_floor(); ///< a btHeightfieldTerrainShape of 100 x 100 cells
/// One open mesh of two sheets that meet along x = 0, with so many cells along that seam on either side.
Floor joined_floor(std::uint32_t left, std::uint32_t right);
/// Two slabs side by side, `gap` metres apart, that of x > 0 higher by `rise` metres, each of cells x cells.
Floor flush_floor(double gap, double rise, std::uint32_t cells = 1);
Floor tiled_floor(double uneven); ///< 12 x 12 cubes of 1 m, flush; each by turns higher by `uneven` metres
/// A closed mesh whose top is higher by `rise` metres for x > 0.
Floor stepped_floor(double rise);

} // namespace raycontact::scenes
