// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geom.h"

#include <cstdint>
#include <span>

namespace raycontact::mujoco {

/// A contact as MuJoCo has it: the position half way between the surfaces, the normal from the first geom to the
/// second, the distance below 0 where they overlap.
struct Point {
    double distance;
    Triple position, normal;
};

/// What all calls so far found and did, over all threads.
struct Counts {
    std::uint64_t calls, contacts, left_out; ///< left_out: contacts for which MuJoCo has no slot; others stand for them
};
RAYCONTACT_API Counts counts();

/// The contacts of two geoms, of which one at least is a mesh, as many as `points` has room for: those that stand for
/// all. margin: metres, up to which surfaces that are apart count; beyond a tenth of the smaller geom the nearest
/// places alone. A function of its arguments alone, whatever was asked before and on whichever thread. Returns how
/// many. Throws InputError for a geom that cannot be a shape.
RAYCONTACT_API std::size_t find_points(const Geom& a, const Geom& b, double margin, std::span<Point> points,
                                       bool& off_centre);

} // namespace raycontact::mujoco
