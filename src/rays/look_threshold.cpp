// SPDX-License-Identifier: Apache-2.0
#include "rays/look_threshold.h"

#include "shape/shape_data.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

// Cost of a full look that finds no rays, in rays followed; `predictive`, where following costs more, has a lower
// ratio.
constexpr double cost_of_look[] = {12, 6}; // iterative, predictive
// Share of the smaller body's diagonal: a pair that moves farther than this in a step is not worth following.
constexpr double farthest = 0.015;

} // namespace

double next_threshold(const PlacedBody& a, const PlacedBody& b, double speed, double last, double look_cost,
                      double follows, bool predictive) {
    const double least = 0.001 * smaller_size(a, b), most = farthest * smaller_size(a, b);
    // Too fast to be followed: a full look in every step. (With `predictive` such pairs do not come here.)
    if (speed > most) return 0.2 * least;
    double threshold = 4 * speed;
    if (last >= least) {
        const double looks = cost_of_look[predictive ? 1 : 0] + look_cost;
        threshold = last * std::clamp(std::sqrt(looks / std::max(follows, 1e-3)), 0.5, 2.0);
    }
    return std::clamp(threshold, least, most);
}

bool is_too_fast_to_predict(const PlacedBody& a, const PlacedBody& b, double speed) {
    const double grain = std::min(a.shape->data().grain, b.shape->data().grain);
    return speed > std::min(farthest * smaller_size(a, b), 0.125 * grain);
}

} // namespace raycontact
