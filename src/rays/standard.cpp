// SPDX-License-Identifier: Apache-2.0
#include "rays/standard.h"

#include "pairs/rounding.h"
#include "rays/cast_standard.h"
#include "shape/shape_data.h"

#include <numeric>

namespace raycontact {

void StandardRays::fill(Device& device, Executor& executor, const ShapeStore& shapes,
                        std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, const Settings& settings) {
    order_pairs(executor, bodies, pairs, host_pairs_); // refuses more pairs than have numbers
    which_.resize(2 * pairs.size());
    std::iota(which_.begin(), which_.end(), 0U);
    device_pairs_.write(device, host_pairs_);
    short_first_ = settings.skip_outside && settings.caster != Caster::basic;
    queue_.fill(device, shapes.arrays(), device_pairs_, short_first_);
}

void StandardRays::fill_near(Device& device, Executor& executor, const ShapeStore& shapes,
                             std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                             std::span<const std::uint32_t> which) {
    which_.assign(which.begin(), which.end());
    order_pairs(executor, bodies, pairs, which, host_pairs_);
    margins_.resize(which.size());
    executor.run(static_cast<std::uint32_t>(which.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto [source, target] = directed_pair(bodies, pairs, which[i]);
            // Of few blocks it is not worth asking which are near.
            const bool few = source.shape->data().header.vertex_block_count <= SMALL_BLOCKS;
            margins_[i] = few ? -1.0f : static_cast<float>(rounding_margin(source, target));
        }
    });
    device_pairs_.write(device, host_pairs_);
    device_margins_.write(device, margins_);
    short_first_ = true;
    queue_.fill_near(device, shapes.arrays(), device_pairs_, device_margins_);
}

void StandardRays::cast(Device& device, Caster caster, const ShapeStore& shapes) {
    cast_standard(device, caster, shapes.arrays(), device_pairs_, queue_.rays(), hits_, short_first_);
}

void StandardRays::count(StepStats& stats) const {
    stats.vertices += queue_.vertices_tested();
    stats.rays += queue_.vertices_inside();
    stats.rays_cast += queue_.rays().size();
    stats.pairs_full += which_.size();
}

} // namespace raycontact
