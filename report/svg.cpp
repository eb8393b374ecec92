// SPDX-License-Identifier: Apache-2.0
#include <report/svg.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace raycontact::report {
namespace {

// The page's colours by day: a file of its own has no style sheet to take them from.
const std::string style =
    "text{font:12px system-ui,\"DejaVu "
    "Sans\",sans-serif;fill:#23262b}.title{font-weight:bold;font-size:14px}.tick,.label,.soft{fill:#6a7079;font-size:"
    "11.5px}.grid{stroke:#e4e1dc}.axis,.notch{stroke:#6a7079}.line{fill:none;stroke-width:1.8;stroke-linejoin:round}";

// Told apart with and without colour vision (Okabe and Ito 2008), two more at the end (Tol 2021).
constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#e69f00", "#56b4e9",
                                   "#cc79a7", "#777777", "#000000", "#882255", "#999933"};

double tick_spacing(double length, int wanted) {
    double power = 1;
    while (power * 10 * wanted <= length) power *= 10;
    while (power * wanted > length) power /= 10;
    for (const double factor : {1.0, 2.0, 5.0})
        if (length / (factor * power) <= wanted) return factor * power;
    return 10 * power;
}

} // namespace

double Axis::at(double value) const {
    if (!(last > first)) return 0.5;
    return logarithmic ? std::log10(value / first) / std::log10(last / first) : (value - first) / (last - first);
}

Axis linear_axis(double first, double last, int wanted, double least) {
    Axis axis{first, last, false, {}};
    const double spacing = std::max(least, tick_spacing(std::max(least, last > first ? last - first : 1), wanted));
    for (double k = std::ceil(first / spacing); k * spacing <= last + 1e-9 * (last - first); ++k)
        axis.ticks.push_back(k * spacing);
    return axis;
}

Axis logarithmic_axis(const std::vector<double>& values) {
    Axis axis{1, 10, true, {}};
    double low = HUGE_VAL, high = 0;
    for (const double value : values) {
        if (!axis.shows(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    const int from = high > 0 ? static_cast<int>(std::floor(std::log10(low))) : 0;
    const int to = high > 0 ? std::max(from + 1, static_cast<int>(std::ceil(std::log10(high)))) : 1;
    for (int power = from; power <= to; ++power) axis.ticks.push_back(std::pow(10, power));
    axis.first = axis.ticks.front();
    axis.last = axis.ticks.back();
    return axis;
}

std::string escape_html(const std::string& text) {
    constexpr std::pair<char, const char*> names[] = {
        {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
    std::string safe;
    for (const char c : text) {
        const auto* named = std::ranges::find(names, c, &std::pair<char, const char*>::first);
        named == std::end(names) ? safe += c : safe += named->second;
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

std::string svg_text(double x, double y, const char* anchor, const char* look, const std::string& words) {
    return fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", look, x, y,
                       anchor, escape_html(words));
}

std::string svg_line(double x1, double y1, double x2, double y2, const char* look) {
    return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", look, x1, y1,
                       x2, y2);
}

std::string colour_style() {
    std::string looks;
    for (std::size_t k = 0; k < std::size(colours); ++k)
        looks += fmt::format(".s{0}{{stroke:{1}}}i.s{0}{{background:{1}}}.k{0}{{fill:{1}}}", k, colours[k]);
    return looks;
}

std::string svg_file(double width, double height, const std::string& title, const std::string& drawing) {
    return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
                       "role=\"img\" aria-label=\"{2}\"><style>{3}</style>\n"
                       "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{4}</svg>\n",
                       width, height, escape_html(title), style + colour_style(), drawing);
}

} // namespace raycontact::report
