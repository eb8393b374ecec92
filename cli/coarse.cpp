// SPDX-License-Identifier: Apache-2.0
#include "cli/coarse.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

namespace {

// In diagonals of the mesh's box: less than the sides of a box, more than a mesh of a few hundred triangles has.
constexpr double longest_fine_edge = 0.25;

} // namespace

void warn_if_coarse(const raycontact::Shape& shape, const raycontact::Settings& settings) {
    if (settings.features != raycontact::Features::vertices) return;
    const raycontact::Vec3 low = shape.box_min(), high = shape.box_max();
    const double part = shape.longest_edge() / std::hypot(high.x - low.x, high.y - low.y, high.z - low.z);
    if (part <= longest_fine_edge) return;
    std::cerr << fmt::format("{}: coarse for --features vertices: an edge is {:.0f} % of its size long and can cross "
                             "another mesh unseen; --features edges sees it\n",
                             shape.name(), 100 * part);
}
