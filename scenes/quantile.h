// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace raycontact::scenes {

/// This part of the values lies below it, 0 to 1; between two of them in proportion, so that 0.5 is the median. 0 of
/// none.
inline double quantile(std::vector<double> values, double part) {
    if (values.empty()) return 0;
    const double place = part * static_cast<double>(values.size() - 1);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::floor(place));
    std::nth_element(values.begin(), at, values.end());
    const double beyond = place - std::floor(place), low = *at;
    return beyond > 0 ? low + beyond * (*std::min_element(at + 1, values.end()) - low) : low;
}

} // namespace raycontact::scenes
