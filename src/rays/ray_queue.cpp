// SPDX-License-Identifier: Apache-2.0
#include "rays/ray_queue.h"

namespace raycontact {

void RayQueue::fill(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                    bool use_grid) {
    counts_.resize(device, pairs.size());
    small_.resize(device, pairs.size());
    launch<KernelId::count_clusters>(device, pairs.size(), pairs, shapes.headers, shapes.clusters, counts_, small_);
    clusters_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_clusters>(device, clusters_.size() > 0 ? pairs.size() : 0, pairs, shapes.headers,
                                     shapes.clusters, small_, firsts_, clusters_);

    counts_.resize(device, clusters_.size());
    inside_.resize(device, clusters_.size());
    launch<KernelId::count_rays>(device, clusters_.size(), use_grid ? 1u : 0u, pairs, shapes.headers,
                                 shapes.vertex_blocks, shapes.outside_cells, clusters_, inside_, counts_);
    vertices_inside_ = scan_.run(device, inside_, firsts_);
    rays_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_rays>(device, rays_.size() > 0 ? clusters_.size() : 0, clusters_, firsts_, rays_);
}

} // namespace raycontact
