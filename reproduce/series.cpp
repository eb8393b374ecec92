// SPDX-License-Identifier: Apache-2.0
#include <reproduce/series.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

Series ranks(const Series& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return values[i] < values[k]; });
    Series rank(values.size());
    for (std::size_t from = 0; from < order.size();) {
        std::size_t end = from + 1;
        while (end < order.size() && values[order[end]] == values[order[from]]) ++end;
        for (std::size_t k = from; k < end; ++k) rank[order[k]] = static_cast<double>(from + end - 1) / 2;
        from = end;
    }
    return rank;
}

} // namespace

double sum(const Series& values) {
    return sum(values, 0, values.size());
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

double rank_correlation(const Series& a, const Series& b) {
    const Series x = ranks(a), y = ranks(b);
    const double middle = (static_cast<double>(x.size()) - 1) / 2; // of either's ranks
    double xy = 0, xx = 0, yy = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        xy += (x[k] - middle) * (y[k] - middle);
        xx += (x[k] - middle) * (x[k] - middle);
        yy += (y[k] - middle) * (y[k] - middle);
    }
    return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
}

} // namespace raycontact::reproduce
