// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace raycontact::report {

/// Bars of one group of a chart; a value not above zero draws no bar.
struct BarGroup {
    std::string name;
    std::vector<std::pair<std::string, double>> bars;
};

/// Horizontal bars on one logarithmic axis, as a whole SVG file. A name has one colour in all groups.
std::string bar_chart(const std::string& title, const std::string& unit, const std::vector<BarGroup>& groups);

} // namespace raycontact::report
