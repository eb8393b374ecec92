// SPDX-License-Identifier: Apache-2.0
#include "rays/ray_queue.h"

namespace raycontact {

void RayQueue::fill(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs) {
    counts_.resize(device, pairs.size());
    launch<KernelId::count_clusters>(device, pairs.size(), pairs, shapes.headers, shapes.clusters, counts_);
    clusters_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_clusters>(device, clusters_.size() > 0 ? pairs.size() : 0, pairs, shapes.headers,
                                     shapes.clusters, firsts_, clusters_);

    counts_.resize(device, clusters_.size());
    launch<KernelId::count_rays>(device, clusters_.size(), pairs, shapes.vertex_blocks, clusters_, counts_);
    rays_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_rays>(device, rays_.size() > 0 ? clusters_.size() : 0, clusters_, firsts_, rays_);
}

} // namespace raycontact
