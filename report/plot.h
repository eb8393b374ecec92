// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::report {

/// One line of a plot, interrupted where an axis cannot show a point.
struct Line {
    std::string name; ///< for the legend and the read-out
    std::vector<std::pair<double, double>> points;
    std::size_t colour = automatic; ///< a number from 0 to 9; lines that belong together have the same
    bool dashed = false;            ///< and then not in the legend
    static constexpr std::size_t automatic = ~std::size_t{0}; ///< its place in the plot
};

/// Lines in one unit over something that is in another.
struct Plot {
    std::string title, unit, note; ///< note: what the figure is, one sentence
    std::vector<Line> lines;
    std::string over{};       ///< what the lower axis is, with its unit
    bool logarithmic = false; ///< both axes, and the points are marked; else the upright axis begins at zero
};

/// What the lower axis of a plot over the steps of a run is.
std::string over_steps(double step_seconds);

/// A <figure> with an inline SVG: grid, axes with units, lines, legend. Colours, two, come from the page's style, the
/// hover read-out from its script, which finds the numbers in `plot_data`. What is beyond a clipped axis is said in the
/// caption.
std::string plot_figure(const Plot& plot);

/// Plots two by two as an SVG file of its own, with its colours in it: titles, legends and notes are inside.
std::string plot_svg(const std::vector<Plot>& plots);

/// Of plots that are all over the same steps: {"steps": [...], "plots": [{"unit", "top", "series": [{"name",
/// "values"}]}]}, JSON, in the order of the figures.
std::string plot_data(const std::vector<Plot>& plots);

/// Bars of one group of a chart; a value not above zero draws no bar.
struct BarGroup {
    std::string name;
    std::vector<std::pair<std::string, double>> bars;
};

/// Horizontal bars on one logarithmic axis, as a whole SVG file. A name has one colour in all groups.
std::string bar_chart(const std::string& title, const std::string& unit, const std::vector<BarGroup>& groups);

} // namespace raycontact::report
