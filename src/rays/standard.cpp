// SPDX-License-Identifier: Apache-2.0
#include "rays/standard.h"

#include "device/launch.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::size_t least_room = 4096; // rays

} // namespace

void cast_in_full(const Update& update, RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const auto run = [&]<KernelId kernel>() {
        launch<kernel>(update.device, batch.count, batch.outcomes.stride(), *batch.pairs, arrays.headers, arrays.memory,
                       batch.rays, batch.hits, batch.outcomes.values());
    };
    if (update.settings.paper.caster == Caster::basic)
        run.operator()<KernelId::cast_rays_basic>();
    else
        run.operator()<KernelId::cast_rays_bvh>();
}

void StandardRays::begin(const Update& update, RayBatch& batch) {
    pairs_.place(update, update.settings.is_speculative());
    batch.resize(update.device, std::max(batch.rays.size(), least_room));
    batch.pairs = &pairs_.placed();
    batch.directed = {};
    cast(update, batch);
}

void StandardRays::cast(const Update& update, RayBatch& batch) {
    const Array<kernels::DirectedPair>& pairs = pairs_.placed();
    const bool use_grid = update.settings.paper.skip_outside && update.settings.paper.caster != Caster::basic;
    search_.find(update, pairs, {}, {}, batch.totals, RayBatch::block_sum);
    search_.count_rays(update, pairs, use_grid, batch.totals, RayBatch::ray_sum, batch.rays.size());
    search_.write_rays(update, batch.totals, RayBatch::ray_sum, 0, batch.rays);
    batch.count = results_of(batch.totals, RayBatch::ray_sum, batch.rays.size());
    cast_in_full(update, batch);
}

bool StandardRays::had_room(Device& device, RayBatch& batch) {
    const std::size_t rays = batch.sums[RayBatch::ray_sum].sums[0], room = batch.rays.size();
    const bool blocks_had = search_.had_room(device, batch.sums[RayBatch::block_sum]);
    if (rays > room) batch.resize(device, rays + rays / 2);
    return blocks_had && rays <= room;
}

void StandardRays::count(const RayBatch& batch, StepStats& stats) const {
    const std::uint64_t found = batch.sums[RayBatch::block_sum].sums[0];
    stats.details.vertices += VERTEX_LANES * found;
    stats.details.rays += batch.sums[RayBatch::ray_sum].sums[1];
    stats.details.pairs_full += 2 * pairs_.count();
    stats.pair_bytes += pairs_.bytes() + found * (sizeof(kernels::PairBlock) + 3 * sizeof(kernels::uint))
                        + std::uint64_t{batch.sums[RayBatch::ray_sum].sums[0]} * RayBatch::bytes_of_ray;
}

} // namespace raycontact
