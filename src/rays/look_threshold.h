// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"

namespace raycontact {

/// How far a pair may move before its next full look, metres, if no setting says so. A longer distance saves full looks
/// but follows more rays, since it must predict farther ahead. The counted costs of both decide, by one factor at each
/// look: counts, not times, so that equal input gives equal results. speed: metres a step. last: the distance of the
/// last look, below 0 if there was none. look_cost: what that look cost, in rays; follows: rays followed since.
double next_threshold(const PlacedBody& a, const PlacedBody& b, double speed, double last, double look_cost,
                      double follows, bool predictive);

/// Whether the pair's vertices reach other triangles within a few steps: then prediction costs more than it saves.
bool is_too_fast_to_predict(const PlacedBody& a, const PlacedBody& b, double speed);

} // namespace raycontact
