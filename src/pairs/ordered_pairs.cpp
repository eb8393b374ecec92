// SPDX-License-Identifier: Apache-2.0
#include "pairs/ordered_pairs.h"

#include "shape/shape_data.h"

namespace raycontact {

void order_pair(const PlacedBody& source, const PlacedBody& target, kernels::OrderedPair& ordered) {
    order_pair(source, target, relative_pose(target.centred, source.centred), ordered);
}

// Written in place: to copy one from the stack, wide loads would wait for the narrow stores that made it.
void order_pair(const PlacedBody& source, const PlacedBody& target, const Pose& relative,
                kernels::OrderedPair& ordered) {
    const kernels::ShapeHeader& shape = target.shape->data().header;
    const float grow = shape.closed != 0 ? 0 : source.shape->data().header.ray_reach;
    for (int i = 0; i < 9; ++i) ordered.rotation[i] = static_cast<float>(relative.rotation[i]);
    ordered.translation[0] = static_cast<float>(relative.translation.x);
    ordered.translation[1] = static_cast<float>(relative.translation.y);
    ordered.translation[2] = static_cast<float>(relative.translation.z);
    for (int k = 0; k < 3; ++k) {
        ordered.bounds[k] = shape.low[k] - grow;
        ordered.bounds[3 + k] = shape.high[k] + grow;
    }
    ordered.source = source.shape_index;
    ordered.target = target.shape_index;
}

void widen(kernels::OrderedPair& pair, float by) {
    for (int k = 0; k < 3; ++k) {
        pair.bounds[k] -= by;
        pair.bounds[3 + k] += by;
    }
}

} // namespace raycontact
