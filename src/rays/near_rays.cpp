// SPDX-License-Identifier: Apache-2.0
#include "rays/near_rays.h"

#include "device/launch.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::size_t least_room = 4096; // edges

} // namespace

RayBatch::Sum NearRays::sum(RayBatch::Sum of_edges) const {
    constexpr int apart = RayBatch::point_block_sum - RayBatch::edge_block_sum;
    return sources_ == BlockSearch::Sources::points ? static_cast<RayBatch::Sum>(of_edges + apart) : of_edges;
}

void NearRays::cast(const Update& update, const Array<kernels::DirectedPair>& pairs,
                    const Array<kernels::DirectedPair>& next, const Reach& reach, const RayBatch& batch) {
    Device& device = update.device;
    const ShapeStore::Arrays& arrays = update.arrays();
    const Array<kernels::Totals>& totals = batch.totals;
    const kernels::uint vertices = sources_ == BlockSearch::Sources::points ? 1 : 0;
    const std::size_t room = std::max(rays_.size(), least_room);
    resize(device, pairs.size(), margins_, horizons_);
    half_way_.resize(device, next.size());
    thrown_.resize(device, vertices != 0 ? next.size() : 0);
    resize(device, room, rays_, hits_);
    counts_.resize(device, 1, room);
    launch<KernelId::find_margins>(device, pairs.size(), pairs, next, reach.more, reach.ahead, arrays.headers, margins_,
                                   horizons_, half_way_, thrown_);
    const Array<kernels::DirectedPair>& placed = next.size() > 0 ? half_way_ : pairs;
    search_.find(update, placed, horizons_, reach.choices, totals, sum(RayBatch::edge_block_sum));
    search_.count_edges(update, placed, next, thrown_, margins_, reach.choices, reach.ahead, totals,
                        sum(RayBatch::edge_ray_sum), room);
    search_.write_rays(update, totals, sum(RayBatch::edge_ray_sum), 0, rays_);
    const Count count = results_of(totals, sum(RayBatch::edge_ray_sum), room);
    launch<KernelId::cast_edges>(device, count, vertices, placed, next, thrown_, margins_, reach.choices,
                                 arrays.headers, arrays.memory, rays_, hits_, counts_.values());
    const Array<kernels::NearEdge>& found = found_.room(device);
    counts_.scan(device, count, totals, sum(RayBatch::edge_sum), found.size());
    launch<KernelId::write_edges>(device, items_of(totals, sum(RayBatch::edge_sum), room), vertices, placed, next,
                                  thrown_, margins_, reach.choices, arrays.headers, arrays.memory, rays_, hits_,
                                  counts_.firsts(), found);
}

bool NearRays::had_room(Device& device, const RayBatch& batch) {
    block_count_ = batch.sums[sum(RayBatch::edge_block_sum)].sums[0];
    ray_count_ = batch.sums[sum(RayBatch::edge_ray_sum)].sums[0];
    const bool blocks_had = search_.had_room(device, batch.sums[sum(RayBatch::edge_block_sum)]);
    const bool rays_had = ray_count_ <= rays_.size();
    if (!rays_had) rays_.resize(device, ray_count_ + ray_count_ / 2);
    return found_.take(device, batch.sums[sum(RayBatch::edge_sum)].sums[0]) && blocks_had && rays_had;
}

void NearRays::rest() {
    search_.rest();
    found_.rest();
    block_count_ = ray_count_ = 0;
}

std::uint64_t NearRays::bytes() const {
    return search_.bytes() + (2 * margins_.size() + thrown_.size()) * sizeof(float)
           + half_way_.size() * sizeof(kernels::DirectedPair)
           + ray_count_ * (sizeof(kernels::Ray) + sizeof(kernels::EdgeHits) + 2 * sizeof(kernels::uint))
           + found_.values().size_bytes();
}

} // namespace raycontact
