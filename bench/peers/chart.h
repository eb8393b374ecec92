// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
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

/// One line of a panel; points whose coordinates are not both above zero are left out.
struct Line {
    std::string name;
    std::vector<std::pair<double, double>> points;
    std::size_t colour = automatic; ///< a number; lines that belong together have the same
    bool dashed = false;
    static constexpr std::size_t automatic = ~std::size_t{0}; ///< its place in the panel
};
struct Panel {
    std::string title, x_unit, y_unit;
    std::vector<Line> lines;
};

/// Panels two by two, both axes logarithmic, as a whole SVG file.
std::string line_chart(const std::vector<Panel>& panels);

} // namespace raycontact::bench
