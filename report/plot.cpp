// SPDX-License-Identifier: Apache-2.0
#include <report/plot.h>

#include <report/svg.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace raycontact::report {
namespace {

// The SVG's own units; the page scales it to its column. The script knows these numbers from the SVG's data attributes.
constexpr double width = 560, left = 58, right = 14, top = 12, bottom = 38;

double height_of(const Plot& plot) {
    return plot.logarithmic ? 330 : 230;
}

template <class Part>
std::vector<double> all(const Plot& plot, Part part) {
    std::vector<double> values;
    for (const Line& line : plot.lines)
        for (const auto& point : line.points) values.push_back(point.*part);
    return values;
}

Axis lower_axis(const Plot& plot) {
    const std::vector<double> all_x = all(plot, &std::pair<double, double>::first);
    if (plot.logarithmic) return logarithmic_axis(all_x);
    const auto [first, last] = std::minmax_element(all_x.begin(), all_x.end());
    if (all_x.empty()) return linear_axis(0, 1, 6, 1);
    Axis axis = linear_axis(*first, *last, 6, 1);
    // The last step has a number of its own, in place of one that stands too near.
    if (axis.ticks.size() > 1 && axis.last > axis.ticks.back()) {
        const double spacing = axis.ticks[1] - axis.ticks[0];
        if (axis.last - axis.ticks.back() < 0.6 * spacing) axis.ticks.pop_back();
        axis.ticks.push_back(axis.last);
    }
    return axis;
}

double largest(const Plot& plot) {
    double most = 0;
    for (const double v : all(plot, &std::pair<double, double>::second))
        if (std::isfinite(v)) most = std::max(most, v);
    return most;
}

/// A linear one ends at the tick beyond the largest value, unless a few spikes would flatten all the rest.
Axis upright_axis(const Plot& plot) {
    std::vector<double> values = all(plot, &std::pair<double, double>::second);
    if (plot.logarithmic) return logarithmic_axis(values);
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return linear_axis(0, 1, 5);
    std::sort(values.begin(), values.end());
    const double most = values.back(), usual = values[(values.size() - 1) * 99 / 100];
    const double end = usual > 0 && most > 3 * usual ? 1.3 * usual : most;
    if (!(end > 0)) return linear_axis(0, 1, 5);
    const double spacing = linear_axis(0, end, 5).ticks.at(1);
    return linear_axis(0, spacing * std::ceil(end / spacing - 1e-9), 5);
}

std::size_t colour_of(const Plot& plot, std::size_t line) {
    return (plot.lines[line].colour == Line::automatic ? line : plot.lines[line].colour) % 10;
}

/// Grid, axes and lines.
std::string drawing(const Plot& plot) {
    const Axis lower = lower_axis(plot), upright = upright_axis(plot);
    const double low = height_of(plot) - bottom;
    const auto px = [&](double v) { return left + (width - left - right) * lower.at(v); };
    const auto py = [&](double v) { return low - (low - top) * std::min(upright.at(v), 1.0); };
    std::string svg;
    for (const double tick : upright.ticks) {
        svg += svg_line(left, py(tick), width - right, py(tick), "grid");
        svg += svg_text(left - 7, py(tick) + 3.5, "end", "tick", readable(tick));
    }
    for (const double tick : lower.ticks) {
        if (plot.logarithmic) svg += svg_line(px(tick), top, px(tick), low, "grid");
        svg += svg_line(px(tick), low, px(tick), low + 4, "notch");
        svg += svg_text(px(tick), low + 16, "middle", "tick", readable(tick));
    }
    svg += svg_line(left, low, width - right, low, "axis");
    svg += svg_text((left + width - right) / 2, low + bottom - 5, "middle", "label", plot.over);
    for (std::size_t k = 0; k < plot.lines.size(); ++k) {
        const Line& line = plot.lines[k];
        std::string path, dots;
        bool pen_down = false;
        for (const auto& [x, y] : line.points) {
            const bool shown = lower.shows(x) && upright.shows(y);
            if (shown) path += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', px(x), py(y));
            if (shown && plot.logarithmic && !line.dashed)
                dots += fmt::format("<circle class=\"k{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", colour_of(plot, k),
                                    px(x), py(y));
            pen_down = shown;
        }
        svg += fmt::format("<path class=\"line s{}\"{} d=\"{}\"/>\n", colour_of(plot, k),
                           line.dashed ? " stroke-dasharray=\"6 4\"" : "", path)
               + dots;
    }
    return svg;
}

/// What the figure is, and what an axis that was cut off does not show.
std::string note_of(const Plot& plot) {
    const double most = largest(plot);
    if (most <= upright_axis(plot).last * (1 + 1e-9)) return plot.note;
    return plot.note
           + fmt::format(" The axis stops below a few spikes; the largest is {} {}.", readable(most), plot.unit);
}

/// Nothing where the title has said it.
std::string unit_of(const Plot& plot) {
    const auto lower = [](std::string text) {
        std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
        return text;
    };
    return lower(plot.title) == lower(plot.unit) ? "" : plot.unit;
}

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

/// Of more than one line: format(number of its colour, safe name) of each.
template <class Format>
std::string legend(const Plot& plot, Format format) {
    std::string text;
    if (plot.lines.size() > 1)
        for (std::size_t k = 0; k < plot.lines.size(); ++k)
            if (!plot.lines[k].dashed && !plot.lines[k].points.empty())
                text += format(colour_of(plot, k), escape_html(plot.lines[k].name));
    return text;
}

} // namespace

std::string over_steps(double step_seconds) {
    return fmt::format("step (one is {} ms)", readable(1000 * step_seconds));
}

std::string plot_figure(const Plot& plot) {
    const double height = height_of(plot);
    return fmt::format(
        "<figure class=\"plot\"><figcaption><b>{}</b> <span class=\"unit\">{}</span>{}<output></output></figcaption>"
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" data-left=\"{}\" data-right=\"{}\" data-top=\"{}\" "
        "data-bottom=\"{}\">{}<g class=\"cursor\"></g></svg><p>{}</p></figure>\n",
        escape_html(plot.title), escape_html(unit_of(plot)),
        legend(plot,
               [](std::size_t colour, const std::string& name) {
                   return fmt::format("<span class=\"key\"><i class=\"s{}\"></i>{}</span>", colour, name);
               }),
        width, height, escape_html(plot.title), left, width - right, top, height - bottom, drawing(plot),
        escape_html(note_of(plot)));
}

std::string plot_svg(const std::vector<Plot>& plots) {
    constexpr double title_row = 30, legend_row = 18, note_row = 16, column_gap = 24; // room for the last tick's number
    std::string svg;
    double row_top = 0, row_height = 0;
    for (std::size_t k = 0; k < plots.size(); ++k) {
        const Plot& plot = plots[k];
        const double column = k % 2 == 0 ? 0 : width + column_gap;
        if (k % 2 == 0) row_top += std::exchange(row_height, 0);
        const std::string names = legend(plot, [](std::size_t colour, const std::string& name) {
            return fmt::format("<tspan class=\"k{}\">\u25a0</tspan> <tspan dx=\"2\">{}</tspan><tspan dx=\"12\"> "
                               "</tspan>",
                               colour, name);
        });
        double y = 20;
        svg += fmt::format("<g transform=\"translate({} {})\"><text x=\"{}\" y=\"{}\"><tspan "
                           "class=\"title\">{}</tspan> <tspan class=\"soft\">{}</tspan></text>\n",
                           column, row_top, left, y, escape_html(plot.title), escape_html(unit_of(plot)));
        if (!names.empty()) svg += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", left, y += legend_row, names);
        y += title_row - 20;
        svg += fmt::format("<g transform=\"translate(0 {})\">\n{}</g>\n", y, drawing(plot));
        y += height_of(plot);
        for (const std::string& words : broken(note_of(plot), 80))
            svg += svg_text(left, y += note_row, "start", "soft", words);
        svg += "</g>\n";
        row_height = std::max(row_height, y + 12);
    }
    return svg_file((plots.size() > 1 ? 2 : 1) * (width + column_gap), row_top + row_height,
                    plots.empty() ? "" : plots.front().title, svg);
}

std::string plot_data(const std::vector<Plot>& plots) {
    nlohmann::json data{{"steps", nlohmann::json::array()}, {"plots", nlohmann::json::array()}};
    if (!plots.empty() && !plots.front().lines.empty())
        for (const auto& [step, value] : plots.front().lines.front().points) data["steps"].push_back(step);
    for (const Plot& plot : plots) {
        nlohmann::json series = nlohmann::json::array();
        for (const Line& line : plot.lines) {
            std::vector<double> values;
            for (const auto& [step, value] : line.points) values.push_back(value);
            series.push_back({{"name", line.name}, {"values", values}});
        }
        data["plots"].push_back({{"unit", plot.unit}, {"top", upright_axis(plot).last}, {"series", series}});
    }
    std::string text = data.dump();
    // Inside a <script> element only this could end it early.
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
    return text;
}

std::string bar_chart(const std::string& title, const std::string& unit, const std::vector<BarGroup>& groups) {
    constexpr double bars_width = 760, bars_left = 190, bars_right = 70, bars_top = 34, row = 19, gap = 30;
    std::vector<double> values;
    for (const BarGroup& group : groups)
        for (const auto& [name, value] : group.bars) values.push_back(value);
    const Axis axis = logarithmic_axis(values);
    const double bars_bottom =
        bars_top + gap * static_cast<double>(groups.size()) + row * static_cast<double>(values.size()) + 8;
    const auto px = [&](double v) { return bars_left + (bars_width - bars_left - bars_right) * axis.at(v); };
    std::string svg = svg_text(12, 20, "start", "title", title);
    for (const double tick : axis.ticks) {
        svg += svg_line(px(tick), bars_top, px(tick), bars_bottom, "grid");
        svg += svg_text(px(tick), bars_bottom + 16, "middle", "tick", readable(tick));
    }
    svg += svg_text((bars_left + bars_width - bars_right) / 2, bars_bottom + 34, "middle", "label", unit);
    std::vector<std::string> names;
    double y = bars_top;
    for (const BarGroup& group : groups) {
        svg += svg_text(12, y + 20, "start", "title", group.name);
        y += gap;
        for (const auto& [name, value] : group.bars) {
            auto known = std::find(names.begin(), names.end(), name);
            if (known == names.end()) known = names.insert(names.end(), name);
            svg += svg_text(bars_left - 8, y + 12, "end", "name", name);
            if (axis.shows(value)) {
                svg += fmt::format("<rect class=\"k{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\"/>\n",
                                   (known - names.begin()) % 10, bars_left, y + 1, px(value) - bars_left, row - 4);
                svg += svg_text(px(value) + 5, y + 12, "start", "value", fmt::format("{:.3g}", value));
            }
            y += row;
        }
    }
    return svg_file(bars_width, bars_bottom + 44, title, svg);
}

} // namespace raycontact::report
