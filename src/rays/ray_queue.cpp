// SPDX-License-Identifier: Apache-2.0
#include "rays/ray_queue.h"

namespace raycontact {

void RayQueue::fill(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                    bool use_grid) {
    finder_.find(device, shapes, pairs);
    queue(device, shapes, pairs, use_grid);
}

void RayQueue::fill_near(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                         const Array<float>& margins) {
    finder_.find_near(device, shapes, pairs, margins);
    queue(device, shapes, pairs, true);
}

void RayQueue::queue(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                     bool use_grid) {
    Array<kernels::Cluster>& blocks = finder_.blocks();
    counts_.resize(device, blocks.size());
    inside_.resize(device, blocks.size());
    launch<KernelId::count_rays>(device, blocks.size(), use_grid ? 1u : 0u, pairs, shapes.headers, shapes.vertex_blocks,
                                 shapes.outside_cells, shapes.clearances, blocks, inside_, counts_);
    vertices_inside_ = scan_.run(device, inside_, firsts_);
    rays_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_rays>(device, rays_.size() > 0 ? blocks.size() : 0, blocks, firsts_, rays_);
}

} // namespace raycontact
