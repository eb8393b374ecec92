// SPDX-License-Identifier: Apache-2.0
#include <reproduce/rank_correlation.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace raycontact::reproduce {

namespace {

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
