// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/sums.h>

#include <algorithm>

namespace raycontact::bench {

void add(StepStats& sums, const StepStats& step) {
    sums.pairs += step.pairs;
    sums.details.vertices += step.details.vertices;
    sums.details.rays += step.details.rays;
    sums.details.rays_cast += step.details.rays_cast;
    sums.details.pairs_full += step.details.pairs_full;
    sums.details.pairs_skipped += step.details.pairs_skipped;
    sums.details.walks += step.details.walks;
    sums.details.walks_lost += step.details.walks_lost;
    sums.details.walk_casts += step.details.walk_casts;
    sums.details.predictions += step.details.predictions;
    sums.contacts += step.contacts;
    sums.pair_bytes = std::max(sums.pair_bytes, step.pair_bytes);
}

} // namespace raycontact::bench
