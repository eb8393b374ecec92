// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace raycontact::report {

/// One line of a plot: a value for each step.
struct Series {
    std::string name; ///< for the legend and the read-out
    std::vector<double> values;
};

/// A plot over the steps of a run, all in one unit, the value axis from zero.
struct Plot {
    std::string title, unit, note; ///< note: what the figure is, one sentence
    std::vector<Series> series;    ///< one or two
};

/// A <figure> with an inline SVG: grid, axes with units, lines, legend. Colours come from the page's style, the hover
/// read-out from its script, which finds the numbers in `plot_data`. Steps outside a clipped axis are said in the
/// caption.
std::string plot_figure(const Plot& plot, const std::vector<double>& steps, double step_seconds);

/// The same as an SVG file of its own, with its colours in it: title, legend and note are inside.
std::string plot_svg(const Plot& plot, const std::vector<double>& steps, double step_seconds);

/// JSON: {"steps": [...], "plots": [{"unit", "top", "series": [{"name", "values"}]}]}, in the order of the figures.
std::string plot_data(const std::vector<Plot>& plots, const std::vector<double>& steps);

/// Text made safe inside HTML and its attributes.
std::string escape_html(const std::string& text);

/// For a person: thousands apart, four significant digits.
std::string readable(double value);

} // namespace raycontact::report
