// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/solid.h"

#include <cstdint>
#include <vector>

namespace raycontact::reference {

inline constexpr std::uint32_t none = 0xffffffffu;

/// An edge of a solid as the rule numbers it.
struct Edge {
    std::uint32_t number = 0;           ///< 3 x its lowest triangle of the file + its corner there
    std::uint32_t from = 0, to = 0;     ///< vertices
    std::uint32_t faces[2] = {0, none}; ///< its lowest triangle, the other one; none at a border
    bool sharp = true;
    bool concave = false;
    double hides = 0; ///< how deep an overlap can be that it alone crosses
};

/// In the order of their numbers.
std::vector<Edge> edges_of(const Solid& solid);

} // namespace raycontact::reference
