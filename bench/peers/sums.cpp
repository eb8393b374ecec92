// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/sums.h>

#include <algorithm>

namespace raycontact::bench {

void add(StepStats& sums, const StepStats& step) {
    sums.pairs += step.pairs;
    sums.vertices += step.vertices;
    sums.rays += step.rays;
    sums.rays_cast += step.rays_cast;
    sums.pairs_full += step.pairs_full;
    sums.pairs_asleep += step.pairs_asleep;
    sums.walks += step.walks;
    sums.walks_lost += step.walks_lost;
    sums.walk_casts += step.walk_casts;
    sums.predictions += step.predictions;
    sums.contacts += step.contacts;
    sums.pair_bytes = std::max(sums.pair_bytes, step.pair_bytes);
}

} // namespace raycontact::bench
