// SPDX-License-Identifier: Apache-2.0
#include "rays/near_blocks.h"

#include "device/launch.h"

namespace raycontact {

void NearBlocks::find(const Update& update, const Array<kernels::OrderedPair>& pairs, const Array<float>& horizons,
                      const Array<kernels::Totals>& totals, std::size_t at) {
    const ShapeStore::Arrays& arrays = update.arrays();
    Device& device = update.device;
    const std::size_t count = horizons.size();
    host_counts_.resize(count);
    host_safe_distances_.resize(count);
    counts_.resize(device, 1, count);
    blocks_.resize(device, 0);
    if (count == 0) return;
    safe_distances_.resize(device, count);
    block_masks_.resize(device, count);
    launch<KernelId::count_clusters>(device, count, pairs, horizons, arrays.headers, arrays.clusters, arrays.clearances,
                                     counts_.values(), safe_distances_, block_masks_);
    counts_.scan(device, count, totals, at, NONE - 1);
    kernels::Totals sum;
    const Piece pieces[] = {totals.piece({&sum, 1}, at), counts_.values().piece(host_counts_),
                            safe_distances_.piece(host_safe_distances_)};
    device.queue().read(pieces);
    check_sums({&sum, 1});
    blocks_.resize(device, sum.results);
    launch<KernelId::write_clusters>(device, sum.results > 0 ? count : 0, pairs, horizons, arrays.headers,
                                     arrays.clusters, arrays.clearances, block_masks_, counts_.firsts(), blocks_);
}

} // namespace raycontact
