// SPDX-License-Identifier: Apache-2.0
#include "rays/edge_rays.h"

#include "device/launch.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::size_t least_room = 4096; // edges

} // namespace

void EdgeRays::cast(const Update& update, const Array<kernels::DirectedPair>& pairs,
                    const Array<kernels::DirectedPair>& next, const Reach& reach, const RayBatch& batch) {
    Device& device = update.device;
    const ShapeStore::Arrays& arrays = update.arrays();
    const Array<kernels::Totals>& totals = batch.totals;
    const std::size_t room = std::max(rays_.size(), least_room);
    resize(device, pairs.size(), margins_, horizons_);
    resize(device, room, rays_, hits_);
    counts_.resize(device, 1, room);
    search_.set(update.settings.is_speculative() ? BlockSearch::Sources::all_edges : BlockSearch::Sources::edges);
    launch<KernelId::find_margins>(device, pairs.size(), pairs, next, reach.more, reach.ahead, arrays.headers, margins_,
                                   horizons_);
    search_.find(update, pairs, horizons_, totals, RayBatch::edge_block_sum);
    search_.count_edges(update, pairs, next, margins_, reach.least, reach.ahead.size() > 0, totals,
                        RayBatch::edge_ray_sum, room);
    search_.write_rays(update, totals, RayBatch::edge_ray_sum, 0, rays_);
    const Count count = results_of(totals, RayBatch::edge_ray_sum, room);
    launch<KernelId::cast_edges>(device, count, pairs, next, margins_, arrays.headers, arrays.memory, rays_, hits_,
                                 counts_.values());
    const Array<kernels::NearEdge>& found = found_.room(device);
    counts_.scan(device, count, totals, RayBatch::edge_sum, found.size());
    launch<KernelId::write_edges>(device, items_of(totals, RayBatch::edge_sum, room), pairs, next, margins_,
                                  arrays.headers, arrays.memory, rays_, hits_, counts_.firsts(), found);
}

bool EdgeRays::had_room(Device& device, const RayBatch& batch) {
    block_count_ = batch.sums[RayBatch::edge_block_sum].sums[0];
    ray_count_ = batch.sums[RayBatch::edge_ray_sum].sums[0];
    const bool blocks_had = search_.had_room(device, batch.sums[RayBatch::edge_block_sum]);
    const bool rays_had = ray_count_ <= rays_.size();
    if (!rays_had) rays_.resize(device, ray_count_ + ray_count_ / 2);
    return found_.take(device, batch.sums[RayBatch::edge_sum].sums[0]) && blocks_had && rays_had;
}

void EdgeRays::rest() {
    search_.rest();
    found_.rest();
    block_count_ = ray_count_ = 0;
}

std::uint64_t EdgeRays::bytes() const {
    return search_.bytes() + 2 * margins_.size() * sizeof(float)
           + ray_count_ * (sizeof(kernels::Ray) + sizeof(kernels::EdgeHits) + 2 * sizeof(kernels::uint))
           + found_.values().size_bytes();
}

void EdgeRays::give_back() {
    search_.give_back(block_count_);
    rays_.give_back(ray_count_);
    hits_.give_back(ray_count_);
    counts_.give_back(ray_count_);
    raycontact::give_back(margins_, horizons_, found_);
}

} // namespace raycontact
