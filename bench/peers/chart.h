// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace raycontact::bench {

/// Bars of one group of a chart; a value not above zero draws no bar.
struct BarGroup {
    std::string name;
    std::vector<std::pair<std::string, double>> bars;
};

/// Horizontal bars on one logarithmic axis, as a whole SVG file.
std::string bar_chart(const std::string& title, const std::string& unit, const std::vector<BarGroup>& groups);

/// One line of a panel; both coordinates above zero.
struct Line {
    std::string name;
    std::vector<std::pair<double, double>> points;
};
struct Panel {
    std::string title, x_unit, y_unit;
    std::vector<Line> lines;
};

/// Panels side by side, both axes logarithmic, as a whole SVG file.
std::string line_chart(const std::vector<Panel>& panels);

} // namespace raycontact::bench
