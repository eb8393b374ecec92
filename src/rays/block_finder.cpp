// SPDX-License-Identifier: Apache-2.0
#include "rays/block_finder.h"

#include "device/launch.h"

namespace raycontact {

void BlockFinder::find(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs) {
    counts_.resize(device, pairs.size());
    small_.resize(device, pairs.size());
    launch<KernelId::count_clusters>(device, pairs.size(), pairs, shapes.headers, shapes.clusters, counts_, small_);
    blocks_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_clusters>(device, blocks_.size() > 0 ? pairs.size() : 0, pairs, shapes.headers,
                                     shapes.clusters, small_, firsts_, blocks_);
}

void BlockFinder::find_near(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                            const Array<float>& horizons) {
    counts_.resize(device, pairs.size());
    clears_.resize(device, pairs.size());
    small_.resize(device, pairs.size());
    launch<KernelId::count_near_clusters>(device, pairs.size(), pairs, horizons, shapes.headers, shapes.clusters,
                                          shapes.clearances, counts_, clears_, small_);
    blocks_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_near_clusters>(device, blocks_.size() > 0 ? pairs.size() : 0, pairs, horizons,
                                          shapes.headers, shapes.clusters, shapes.clearances, small_, firsts_, blocks_);
}

} // namespace raycontact
