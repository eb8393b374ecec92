// SPDX-License-Identifier: Apache-2.0
#include <report/plot.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

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

/// Grid, axes and lines, in the units of `width` and `height`.
std::string drawing(const Plot& plot, const std::vector<double>& steps, double step_seconds) {
    const double end = axis_end(plot);
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
    return svg;
}

/// What the figure is, and what an axis that was cut off does not show.
std::string note_of(const Plot& plot) {
    const double end = axis_end(plot), most = largest(plot);
    if (most <= end * (1 + 1e-9)) return plot.note;
    return plot.note
           + fmt::format(" The axis stops below a few spikes; the largest is {} {}.", readable(most), plot.unit);
}

// The page's colours by day: a file of its own has no style sheet to take them from.
constexpr const char* file_style =
    "text{font:12px system-ui,\"DejaVu Sans\",sans-serif;fill:#23262b}.title{font-weight:bold;font-size:14px}"
    ".tick,.label,.soft{fill:#6a7079;font-size:11.5px}.grid{stroke:#e4e1dc}.axis,.notch{stroke:#6a7079}"
    ".line{fill:none;stroke-width:1.6;stroke-linejoin:round}.s0{stroke:#2f6fb0}.s1{stroke:#d9662f}"
    ".k0{fill:#2f6fb0}.k1{fill:#d9662f}";

/// Lines of at most so many characters: SVG does not break text by itself.
std::vector<std::string> broken(const std::string& text, std::size_t most) {
    std::vector<std::string> lines;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (lines.empty() || lines.back().size() + 1 + word.size() > most)
            lines.push_back(word);
        else
            lines.back() += " " + word;
    }
    return lines;
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
    std::string legend;
    if (plot.series.size() > 1)
        for (std::size_t k = 0; k < plot.series.size(); ++k)
            legend +=
                fmt::format("<span class=\"key\"><i class=\"s{}\"></i>{}</span>", k, escape_html(plot.series[k].name));
    return fmt::format(
        "<figure class=\"plot\"><figcaption><b>{}</b> <span class=\"unit\">{}</span>{}<output></output></figcaption>"
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" data-left=\"{}\" data-right=\"{}\" "
        "data-top=\"{}\" data-bottom=\"{}\">{}<g class=\"cursor\"></g></svg><p>{}</p></figure>\n",
        escape_html(plot.title), escape_html(plot.unit), legend, width, height, escape_html(plot.title), left,
        width - right, top, height - bottom, drawing(plot, steps, step_seconds), escape_html(note_of(plot)));
}

std::string plot_svg(const Plot& plot, const std::vector<double>& steps, double step_seconds) {
    constexpr double head = 30, line = 16;
    const std::vector<std::string> note = broken(note_of(plot), 80);
    std::string words = fmt::format("<text x=\"{}\" y=\"20\"><tspan class=\"title\">{}</tspan> <tspan "
                                    "class=\"soft\">{}</tspan>",
                                    left, escape_html(plot.title), escape_html(plot.unit));
    if (plot.series.size() > 1)
        for (std::size_t k = 0; k < plot.series.size(); ++k)
            words += fmt::format("<tspan class=\"k{}\" dx=\"14\">{}</tspan>", k, escape_html(plot.series[k].name));
    words += "</text>";
    for (std::size_t k = 0; k < note.size(); ++k)
        words += fmt::format("<text class=\"soft\" x=\"{}\" y=\"{}\">{}</text>", left,
                             head + height + line * static_cast<double>(k + 1), escape_html(note[k]));
    return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
                       "height=\"{1}\" role=\"img\" aria-label=\"{2}\"><style>{3}</style><rect width=\"100%\" "
                       "height=\"100%\" fill=\"#fff\"/>{4}<g transform=\"translate(0 {5})\">{6}</g></svg>\n",
                       width, head + height + line * static_cast<double>(note.size()) + 12, escape_html(plot.title),
                       file_style, words, head, drawing(plot, steps, step_seconds));
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
