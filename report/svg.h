// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace raycontact::report {

/// A way along the page that stands for numbers.
struct Axis {
    double first = 0, last = 1;
    bool logarithmic = false;
    std::vector<double> ticks;

    bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
    /// 0 at its beginning, 1 at its end.
    double at(double value) const;
};

/// Ticks at 1, 2 or 5 times a power of ten, no nearer than `least`, about `wanted` of them.
Axis linear_axis(double first, double last, int wanted, double least = 0);
/// Over whole powers of ten, so that all values it can show are on it.
Axis logarithmic_axis(const std::vector<double>& values);

/// Text made safe inside HTML, SVG and their attributes.
std::string escape_html(const std::string& text);

/// For a person: thousands apart, four significant digits.
std::string readable(double value);

// Pieces of a drawing. What they look like is their class's affair: title, label, tick, soft; grid, axis, notch. Of the
// n-th thing (counted from 0) sn is a stroke and kn a filling, of one colour out of ten.
std::string svg_text(double x, double y, const char* anchor, const char* look, const std::string& words);
std::string svg_line(double x1, double y1, double x2, double y2, const char* look);

/// The colours as a style sheet; those of a page's legend, i.sn, too.
std::string colour_style();

/// A file of its own, with its colours in it.
std::string svg_file(double width, double height, const std::string& title, const std::string& drawing);

} // namespace raycontact::report
