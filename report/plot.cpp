// SPDX-License-Identifier: Apache-2.0
#include <report/plot.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace raycontact::report {
namespace {

// The SVG's own units; the page scales it to its column. The script knows these numbers from the SVG's data attributes.
constexpr double width = 560, height = 230, left = 58, right = 14, top = 12, bottom = 38;

/// The steps of an axis: 1, 2 or 5 times a power of ten, about `wanted` of them up to `most`.
double tick_spacing(double most, int wanted) {
    double power = 1;
    while (power * 10 * wanted <= most) power *= 10;
    while (power * wanted > most) power /= 10;
    for (const double factor : {1.0, 2.0, 5.0})
        if (most / (factor * power) <= wanted) return factor * power;
    return 10 * power;
}

double largest(const Plot& plot) {
    double most = 0;
    for (const Series& s : plot.series)
        for (const double v : s.values)
            if (std::isfinite(v)) most = std::max(most, v);
    return most;
}

/// Where the value axis ends: the largest value, unless a few spikes would flatten all the rest.
double axis_end(const Plot& plot) {
    std::vector<double> all;
    for (const Series& s : plot.series)
        for (const double v : s.values)
            if (std::isfinite(v)) all.push_back(v);
    if (all.empty()) return 1;
    std::sort(all.begin(), all.end());
    const double most = all.back(), usual = all[(all.size() - 1) * 99 / 100];
    const double end = usual > 0 && most > 3 * usual ? 1.3 * usual : most;
    if (!(end > 0)) return 1;
    const double spacing = tick_spacing(end, 5);
    return spacing * std::ceil(end / spacing - 1e-9);
}

std::string polyline(const Series& series, std::size_t index, const std::vector<double>& steps, double first,
                     double last, double end) {
    std::string path;
    bool pen_down = false;
    for (std::size_t k = 0; k < series.values.size(); ++k) {
        const double v = series.values[k];
        if (!std::isfinite(v)) {
            pen_down = false;
            continue;
        }
        const double x = left + (width - left - right) * (last > first ? (steps[k] - first) / (last - first) : 0.5);
        const double y = height - bottom - (height - top - bottom) * std::min(v / end, 1.0);
        path += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', x, y);
        pen_down = true;
    }
    return fmt::format("<path class=\"line s{}\" d=\"{}\"/>", index, path);
}

} // namespace

std::string escape_html(const std::string& text) {
    std::string safe;
    for (const char c : text) switch (c) {
        case '&':
            safe += "&amp;";
            break;
        case '<':
            safe += "&lt;";
            break;
        case '>':
            safe += "&gt;";
            break;
        case '"':
            safe += "&quot;";
            break;
        case '\'':
            safe += "&#39;";
            break;
        default:
            safe += c;
        }
    return safe;
}

std::string readable(double value) {
    if (!std::isfinite(value)) return "-";
    if (value != 0 && std::fabs(value) < 1e-3) return fmt::format("{:.3g}", value);
    if (std::fabs(value) < 1000) return fmt::format("{:.4g}", value);
    std::string digits = fmt::format("{:.0f}", value);
    for (std::size_t at = digits.size(); at > (value < 0 ? 4u : 3u);) digits.insert(at -= 3, "\u202f"); // thin spaces
    return digits;
}

std::string plot_figure(const Plot& plot, const std::vector<double>& steps, double step_seconds) {
    const double end = axis_end(plot), most = largest(plot);
    const double first = steps.empty() ? 0 : steps.front(), last = steps.empty() ? 1 : steps.back();
    std::string svg;
    const double value_spacing = tick_spacing(end, 5);
    for (int k = 0; k * value_spacing <= end * (1 + 1e-9); ++k) {
        const double y = height - bottom - (height - top - bottom) * (k * value_spacing / end);
        svg += fmt::format("<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", left,
                           width - right, y, y);
        svg += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", left - 7,
                           y + 3.5, readable(k * value_spacing));
    }
    const double step_spacing = std::max(1.0, tick_spacing(std::max(1.0, last - first), 6));
    for (double at = std::ceil(first / step_spacing) * step_spacing; at <= last; at += step_spacing) {
        const double x = left + (width - left - right) * (last > first ? (at - first) / (last - first) : 0.5);
        svg += fmt::format("<line class=\"notch\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>", x,
                           height - bottom, height - bottom + 4);
        svg += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", x,
                           height - bottom + 16, readable(at));
    }
    svg += fmt::format("<line class=\"axis\" x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/>", left, width - right,
                       height - bottom, height - bottom);
    svg += fmt::format("<text class=\"label\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">step (one is {} ms)</text>",
                       (left + width - right) / 2, height - 5, readable(1000 * step_seconds));
    for (std::size_t k = 0; k < plot.series.size(); ++k) svg += polyline(plot.series[k], k, steps, first, last, end);

    std::string legend;
    if (plot.series.size() > 1)
        for (std::size_t k = 0; k < plot.series.size(); ++k)
            legend +=
                fmt::format("<span class=\"key\"><i class=\"s{}\"></i>{}</span>", k, escape_html(plot.series[k].name));
    std::string note = escape_html(plot.note);
    if (most > end * (1 + 1e-9))
        note += fmt::format(" The axis stops below a few spikes; the largest is {} {}.", readable(most),
                            escape_html(plot.unit));
    return fmt::format(
        "<figure class=\"plot\"><figcaption><b>{}</b> <span class=\"unit\">{}</span>{}<output></output></figcaption>"
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" data-left=\"{}\" data-right=\"{}\" "
        "data-top=\"{}\" data-bottom=\"{}\">{}<g class=\"cursor\"></g></svg><p>{}</p></figure>\n",
        escape_html(plot.title), escape_html(plot.unit), legend, width, height, escape_html(plot.title), left,
        width - right, top, height - bottom, svg, note);
}

std::string plot_data(const std::vector<Plot>& plots, const std::vector<double>& steps) {
    nlohmann::json data{{"steps", steps}, {"plots", nlohmann::json::array()}};
    for (const Plot& plot : plots) {
        nlohmann::json series = nlohmann::json::array();
        for (const Series& s : plot.series) series.push_back({{"name", s.name}, {"values", s.values}});
        data["plots"].push_back({{"unit", plot.unit}, {"top", axis_end(plot)}, {"series", series}});
    }
    std::string text = data.dump();
    // Inside a <script> element only this could end it early.
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
    return text;
}

} // namespace raycontact::report
