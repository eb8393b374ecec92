// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/solid.h"

#include <array>

namespace raycontact::reference {

/// Winding number of a closed surface about a point (relative to the solid's centre), by solid angles
/// (van Oosterom and Strackee 1983): 0 outside, 1 inside.
double winding_number(const Solid& solid, const Vec3& point);

/// Answers many inside-or-outside questions about one closed solid: crossings of an axis-parallel line, found in a
/// grid over the plane across it. A point whose line passes an edge too closely is not sure.
class SideIndex {
public:
    explicit SideIndex(const Solid& solid);
    enum class Side { outside, inside, unsure };
    /// Tries each of the three axes until one is sure.
    Side side(const Vec3& point) const;

private:
    struct Axis {
        double low_u = 0, low_v = 0, per_u = 0, per_v = 0; ///< grid origin, cells per metre
        std::vector<std::uint32_t> first;                  ///< of each cell in `triangles`, one more at the end
        std::vector<std::uint32_t> triangles;
    };
    Axis make_axis(int axis) const;
    Side side_along(int axis, const Vec3& point) const;

    const Solid& solid_;
    std::array<Axis, 3> axes_;
};

} // namespace raycontact::reference
