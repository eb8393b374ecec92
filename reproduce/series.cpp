// SPDX-License-Identifier: Apache-2.0
#include <reproduce/series.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace raycontact::reproduce {

namespace {

template <class Value>
report::Line windows(std::string name, std::size_t steps, Value value) {
    report::Line line{std::move(name), {}};
    const std::size_t length = std::max<std::size_t>(1, (steps + 199) / 200);
    for (std::size_t from = 0; from < steps; from += length) {
        const std::size_t end = std::min(steps, from + length);
        // The ends stay at the first and last step, so that the axis covers the whole run.
        const double x = from == 0      ? 0
                         : end == steps ? static_cast<double>(steps - 1)
                                        : (static_cast<double>(from) + static_cast<double>(end - 1)) / 2;
        line.points.emplace_back(x, value(from, end));
    }
    return line;
}

double sum(const Series& values, std::size_t from, std::size_t end) {
    return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(from),
                           values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
}

} // namespace

double sum(const Series& values) {
    return sum(values, 0, values.size());
}

double median(Series values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

report::Line line(std::string name, const Series& values) {
    return windows(std::move(name), values.size(), [&](std::size_t from, std::size_t end) {
        return sum(values, from, end) / static_cast<double>(end - from);
    });
}

report::Line percent_line(std::string name, const Series& part, const Series& whole) {
    return windows(std::move(name), part.size(), [&](std::size_t from, std::size_t end) {
        const double all = sum(whole, from, end);
        return all > 0 ? 100 * sum(part, from, end) / all : 0;
    });
}

double share(double part, double whole) {
    return whole > 0 ? 100 * part / whole : 0;
}

double less_by(double first, double second) {
    return first > 0 ? 100 * (1 - second / first) : 0;
}

std::string percent(double value, int digits) {
    return fmt::format("{:.{}f} %", value, digits);
}

} // namespace raycontact::reproduce
