// SPDX-License-Identifier: Apache-2.0
#include <report/bars.h>

#include <report/svg.h>

#include <fmt/format.h>

#include <algorithm>

namespace raycontact::report {

std::string bar_chart(const std::string& title, const std::string& unit, const std::vector<BarGroup>& groups) {
    constexpr double width = 760, left = 190, right = 70, top = 34, row = 19, gap = 30;
    std::vector<double> values;
    for (const BarGroup& group : groups)
        for (const auto& [name, value] : group.bars) values.push_back(value);
    const Axis axis = logarithmic_axis(values);
    const double bottom = top + gap * static_cast<double>(groups.size()) + row * static_cast<double>(values.size()) + 8;
    const auto px = [&](double v) { return left + (width - left - right) * axis.at(v); };
    std::string svg = svg_text(12, 20, "start", "title", title);
    for (const double tick : axis.ticks) {
        svg += svg_line(px(tick), top, px(tick), bottom, "grid");
        svg += svg_text(px(tick), bottom + 16, "middle", "tick", readable(tick));
    }
    svg += svg_text((left + width - right) / 2, bottom + 34, "middle", "label", unit);
    std::vector<std::string> names;
    double y = top;
    for (const BarGroup& group : groups) {
        svg += svg_text(12, y + 20, "start", "title", group.name);
        y += gap;
        for (const auto& [name, value] : group.bars) {
            auto known = std::find(names.begin(), names.end(), name);
            if (known == names.end()) known = names.insert(names.end(), name);
            svg += svg_text(left - 8, y + 12, "end", "name", name);
            if (axis.shows(value)) {
                svg += fmt::format("<rect class=\"k{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\"/>\n",
                                   (known - names.begin()) % 10, left, y + 1, px(value) - left, row - 4);
                svg += svg_text(px(value) + 5, y + 12, "start", "value", fmt::format("{:.3g}", value));
            }
            y += row;
        }
    }
    return svg_file(width, bottom + 44, title, svg);
}

} // namespace raycontact::report
