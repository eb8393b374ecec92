// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace raycontact {

/// What --unit takes.
struct LengthUnit {
    const char* name;
    double metres;
};
constexpr std::array length_units{LengthUnit{"m", 1}, LengthUnit{"mm", 1e-3}, LengthUnit{"cm", 1e-2},
                                  LengthUnit{"in", 0.0254}};

/// Null: there is none of that name.
inline const LengthUnit* length_unit(std::string_view name) {
    const auto found = std::ranges::find_if(length_units, [&](const LengthUnit& unit) { return unit.name == name; });
    return found == length_units.end() ? nullptr : found;
}

} // namespace raycontact
