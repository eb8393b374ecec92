// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>

namespace raycontact::scenes {

// Closed, outward meshes, metres. z is their axis.

Mesh solid_box(const Vec3& size); ///< about the origin, 12 triangles

/// Of a metric thread: trapezoids of 60 degrees.
struct Thread {
    double outer = 0.010;  ///< radius, metres
    double pitch = 0.0025; ///< metres
    double play = 0.0001;  ///< between the radii of bolt and nut
    double length = 0.060; ///< of the bolt's thread
    double nut = 0.016;    ///< height
    double across = 0.030; ///< flats of the nut
    std::uint32_t around = 72;
};
Mesh threaded_bolt(const Thread& thread); ///< its thread from z = 0 to `length`, a head below
/// Its thread fits the bolt's where it is; z from 0 to `nut`.
Mesh threaded_nut(const Thread& thread);

} // namespace raycontact::scenes
