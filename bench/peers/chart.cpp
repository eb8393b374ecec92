// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact::bench {

namespace {

// Told apart with and without colour vision (Okabe and Ito 2008), two more at the end (Tol 2021).
constexpr const char* colours[] = {"#0072b2", "#56b4e9", "#d55e00", "#e69f00", "#009e73",
                                   "#cc79a7", "#777777", "#000000", "#882255", "#999933"};
const char* colour(std::size_t i) {
    return colours[i % std::size(colours)];
}

std::string escape(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '&')
            safe += "&amp;";
        else if (c == '<')
            safe += "&lt;";
        else if (c == '>')
            safe += "&gt;";
        else
            safe += c;
    }
    return safe;
}

std::string text(double x, double y, const char* anchor, const std::string& words, const char* extra = "") {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y, anchor, extra,
                       escape(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* stroke) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
                       y2, stroke);
}

std::string document(double width, double height, const std::string& inside) {
    return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
                       "height=\"{1:.0f}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n"
                       "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{2}</svg>\n",
                       width, height, inside);
}

/// A logarithmic axis over whole powers of ten that hold all values given to it.
struct Axis {
    double low = std::numeric_limits<double>::infinity(), high = 0;
    void add(double value) {
        if (!(value > 0) || !std::isfinite(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    int first() const { return high > 0 ? static_cast<int>(std::floor(std::log10(low))) : 0; }
    int last() const { return high > 0 ? std::max(first() + 1, static_cast<int>(std::ceil(std::log10(high)))) : 1; }
    double at(double value) const { return (std::log10(value) - first()) / (last() - first()); }
};

std::string short_number(double value) {
    return value >= 1e6   ? fmt::format("{:g} M", value / 1e6)
           : value >= 1e4 ? fmt::format("{:g} k", value / 1e3)
                          : fmt::format("{:g}", value);
}

std::string panel_svg(const Panel& panel, double left, double top, double width, double height) {
    Axis x, y;
    for (const Line& l : panel.lines) {
        for (const auto& [a, b] : l.points) {
            x.add(a);
            y.add(b);
        }
    }
    const auto px = [&](double v) { return left + width * x.at(v); };
    const auto py = [&](double v) { return top + height * (1 - y.at(v)); };
    std::string svg = text(left, top - 24, "start", panel.title, "font-weight=\"bold\"");
    for (int e = x.first(); e <= x.last(); ++e) {
        const double at = px(std::pow(10, e));
        svg += line(at, top, at, top + height, "#ddd");
        svg += text(at, top + height + 16, "middle", short_number(std::pow(10, e)));
    }
    for (int e = y.first(); e <= y.last(); ++e) {
        const double at = py(std::pow(10, e));
        svg += line(left, at, left + width, at, "#ddd");
        svg += text(left - 6, at + 4, "end", short_number(std::pow(10, e)));
    }
    svg += text(left + width / 2, top + height + 34, "middle", panel.x_unit);
    svg += text(left, top - 8, "start", panel.y_unit, "fill=\"#666\"");
    // The key is where the lines begin farther away; dashed ones have the colour of another.
    int named = 0, high = 0, low = 0, shown = 0;
    for (const Line& one : panel.lines) {
        if (one.points.empty()) continue;
        named += one.dashed ? 0 : 1;
        const auto [a, b] = one.points.front();
        if (a > 0 && b > 0) ++(y.at(b) > 0.5 ? high : low);
    }
    const double key_top = high > low ? top + height - 16 * named : top + 14;
    for (std::size_t k = 0; k < panel.lines.size(); ++k) {
        const Line& one = panel.lines[k];
        if (one.points.empty()) continue;
        const char* stroke = colour(one.colour == Line::automatic ? k : one.colour);
        std::string path, dots;
        for (const auto& [a, b] : one.points) {
            if (!(a > 0) || !(b > 0)) continue;
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', px(a), py(b));
            dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", px(a), py(b), stroke);
        }
        svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", path, stroke,
                           one.dashed ? " stroke-dasharray=\"6 4\"" : "");
        if (one.dashed) continue;
        svg += dots;
        const double key = key_top + 16 * shown++;
        svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"10\" height=\"10\" fill=\"{}\"/>\n", left + 8,
                           key - 9, stroke);
        svg += text(left + 24, key, "start", one.name);
    }
    return svg;
}

} // namespace

std::string bar_chart(const std::string& title, const std::string& unit, const std::vector<BarGroup>& groups) {
    constexpr double width = 760, left = 190, right = 70, top = 34, row = 19, gap = 30;
    Axis axis;
    double height = top;
    for (const BarGroup& group : groups) {
        height += gap + row * static_cast<double>(group.bars.size());
        for (const auto& [name, value] : group.bars) axis.add(value);
    }
    const double bottom = height + 8;
    const auto px = [&](double v) { return left + (width - left - right) * axis.at(v); };
    std::string svg = text(12, 20, "start", title, "font-weight=\"bold\"");
    for (int e = axis.first(); e <= axis.last(); ++e) {
        const double at = px(std::pow(10, e));
        svg += line(at, top, at, bottom, "#ddd");
        svg += text(at, bottom + 16, "middle", short_number(std::pow(10, e)));
    }
    svg += text((left + width - right) / 2, bottom + 34, "middle", unit);
    // A name has one colour in all groups.
    std::vector<std::string> names;
    double y = top;
    for (const BarGroup& group : groups) {
        svg += text(12, y + 20, "start", group.name, "font-weight=\"bold\"");
        y += gap;
        for (const auto& [name, value] : group.bars) {
            auto known = std::find(names.begin(), names.end(), name);
            if (known == names.end()) known = names.insert(names.end(), name);
            svg += text(left - 8, y + 12, "end", name);
            if (value > 0 && std::isfinite(value)) {
                svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\" fill=\"{}\"/>\n",
                                   left, y + 1, px(value) - left, row - 4,
                                   colour(static_cast<std::size_t>(known - names.begin())));
                svg += text(px(value) + 5, y + 12, "start", fmt::format("{:.3g}", value));
            }
            y += row;
        }
    }
    return document(width, bottom + 44, svg);
}

std::string line_chart(const std::vector<Panel>& panels) {
    constexpr double left = 56, width = 330, height = 260, top = 56, pitch_x = left + width + 34,
                     pitch_y = top + height + 50;
    std::string svg;
    for (std::size_t k = 0; k < panels.size(); ++k) {
        const std::size_t row = k / 2;
        svg += panel_svg(panels[k], left + pitch_x * static_cast<double>(k % 2),
                         top + pitch_y * static_cast<double>(row), width, height);
    }
    const std::size_t rows = (panels.size() + 1) / 2;
    return document(pitch_x * (panels.size() > 1 ? 2 : 1) + 10, pitch_y * static_cast<double>(rows), svg);
}

} // namespace raycontact::bench
