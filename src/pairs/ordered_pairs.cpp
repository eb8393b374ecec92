// SPDX-License-Identifier: Apache-2.0
#include "pairs/ordered_pairs.h"

#include "shape/shape_data.h"

#include <limits>
#include <stdexcept>

namespace raycontact {

void order_pair(const PlacedBody& source, const PlacedBody& target, kernels::OrderedPair& ordered) {
    order_pair(source, target, relative_pose(target.centred, source.centred), ordered);
}

// Written where it is to be: one made on the stack is copied in words that no store has just written, and waits.
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

void order_pairs(Executor& executor, std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                 std::vector<kernels::OrderedPair>& ordered) {
    if (pairs.size() >= std::numeric_limits<std::uint32_t>::max() / 2)
        throw std::length_error("more than 2^31 pairs in one step; give fewer");
    ordered.resize(2 * pairs.size());
    executor.run(static_cast<std::uint32_t>(pairs.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t p = begin; p < end; ++p) {
            const PlacedBody& a = bodies[pairs[p].first];
            const PlacedBody& b = bodies[pairs[p].second];
            order_pair(a, b, ordered[2 * p]);
            order_pair(b, a, ordered[2 * p + 1]);
        }
    });
}

void order_pairs(Executor& executor, std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                 std::span<const std::uint32_t> which, std::vector<kernels::OrderedPair>& ordered) {
    ordered.resize(which.size());
    executor.run(static_cast<std::uint32_t>(which.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto [source, target] = directed_pair(bodies, pairs, which[i]);
            order_pair(source, target, ordered[i]);
        }
    });
}

} // namespace raycontact
