// SPDX-License-Identifier: Apache-2.0
#include "pairs/directed_pairs.h"

#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

double smaller_size(const PlacedBody& a, const PlacedBody& b) {
    return std::min(a.shape->data().diagonal, b.shape->data().diagonal);
}

double speculative_margin(const Settings& settings, const PlacedBody& a, const PlacedBody& b) {
    if (const double own = std::max(a.margin, b.margin); own >= 0) return own;
    return settings.speculative_margin ? *settings.speculative_margin : speculative_share * smaller_size(a, b);
}

void place_source(const PlacedBody& source, const PlacedBody& target, kernels::DirectedPair& placed) {
    place_source(source, target, relative_pose(target.centred, source.centred), placed);
}

// Written in place: to copy one from the stack, wide loads would wait for the narrow stores that made it.
void place_source(const PlacedBody& source, const PlacedBody& target, const Pose& relative,
                  kernels::DirectedPair& placed) {
    const kernels::ShapeHeader& shape = target.shape->data().header;
    const float grow = shape.closed != 0 ? 0 : source.shape->data().header.ray_reach;
    for (int i = 0; i < 9; ++i) placed.rotation[i] = static_cast<float>(relative.rotation[i]);
    placed.translation[0] = static_cast<float>(relative.translation.x);
    placed.translation[1] = static_cast<float>(relative.translation.y);
    placed.translation[2] = static_cast<float>(relative.translation.z);
    for (int k = 0; k < 3; ++k) {
        placed.bounds[k] = shape.low[k] - grow;
        placed.bounds[3 + k] = shape.high[k] + grow;
    }
    placed.source = source.shape_index;
    placed.target = target.shape_index;
}

void widen(kernels::DirectedPair& pair, float by) {
    for (int k = 0; k < 3; ++k) {
        pair.bounds[k] -= by;
        pair.bounds[3 + k] += by;
    }
}

} // namespace raycontact
