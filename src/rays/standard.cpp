// SPDX-License-Identifier: Apache-2.0
#include "rays/standard.h"

#include "device/launch.h"

namespace raycontact {

namespace {

constexpr std::size_t least_room = 4096; // blocks, rays

} // namespace

void StandardRays::begin(const Update& update, RayBatch& batch) {
    pairs_.place(update);
    blocks_.grow(update.device, least_room);
    batch.resize(update.device, std::max(batch.rays.size(), least_room));
    batch.pairs = &pairs_.ordered();
    batch.directed = pairs_.directed();
    cast(update, batch);
}

void StandardRays::cast(const Update& update, RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const Array<kernels::OrderedPair>& pairs = pairs_.ordered();
    const bool use_grid = update.settings.skip_outside && update.settings.caster != Caster::basic;
    block_counts_.resize(update.device, 1, pairs.size());
    block_masks_.resize(update.device, pairs.size());
    const Array<float> none; // every block that may reach into the bounds
    launch<KernelId::count_clusters>(update.device, pairs.size(), pairs, none, arrays.headers, arrays.clusters,
                                     arrays.clearances, block_counts_.values(), none, block_masks_);
    block_counts_.scan(update.device, pairs.size(), batch.totals, RayBatch::block_sum, blocks_.size());
    launch<KernelId::write_clusters>(update.device, items_of(batch.totals, RayBatch::block_sum, pairs.size()), pairs,
                                     none, arrays.headers, arrays.clusters, arrays.clearances, block_masks_,
                                     block_counts_.firsts(), blocks_);

    const Count found = results_of(batch.totals, RayBatch::block_sum, blocks_.size());
    ray_counts_.resize(update.device, 2, blocks_.size());
    launch<KernelId::count_rays>(update.device, found, use_grid ? 1u : 0u, ray_counts_.stride(), pairs, arrays.headers,
                                 arrays.vertex_blocks, arrays.outside_cells, arrays.clearances, blocks_,
                                 ray_counts_.values());
    ray_counts_.scan(update.device, found, batch.totals, RayBatch::ray_sum, batch.rays.size());
    launch<KernelId::write_rays>(update.device, items_of(batch.totals, RayBatch::ray_sum, blocks_.size()), 0u, blocks_,
                                 ray_counts_.firsts(), batch.rays);

    batch.count = results_of(batch.totals, RayBatch::ray_sum, batch.rays.size());
    cast_in_full(update, batch, use_grid);
}

bool StandardRays::had_room(Device& device, RayBatch& batch) {
    const std::size_t blocks = batch.sums[RayBatch::block_sum].sums[0], rays = batch.sums[RayBatch::ray_sum].sums[0];
    const bool fits = blocks <= blocks_.size() && rays <= batch.rays.size();
    blocks_.grow(device, blocks);
    if (rays > batch.rays.size()) batch.resize(device, rays + rays / 2);
    return fits;
}

void StandardRays::count(const RayBatch& batch, std::size_t pairs, StepStats& stats) {
    stats.vertices += std::uint64_t{VERTEX_LANES} * batch.sums[RayBatch::block_sum].sums[0];
    stats.rays += batch.sums[RayBatch::ray_sum].sums[1];
    stats.rays_cast += batch.sums[RayBatch::ray_sum].sums[0];
    stats.pairs_full += 2 * pairs;
}

} // namespace raycontact
