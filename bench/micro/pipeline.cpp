// SPDX-License-Identifier: Apache-2.0
#include "bench/micro/pipeline.h"

#include "bench/micro/copy.h"

#include "device/cpu/device.h"

#include <algorithm>
#include <stdexcept>

namespace raycontact::bench {

Pipeline::Pipeline(Executor& executor, std::string_view instruction_set, const Batch& batch)
    : device_(cpu::open(executor, instruction_set)), store_(*device_) {
    store_.add(batch.shape);
    pairs_.write(*device_, batch.ordered);
    pair_clusters_.resize(*device_, pairs_.size());
    small_.resize(*device_, pairs_.size());
    find_clusters();
    find_rays();
    hits_.resize(*device_, rays_.size());
    cast_bvh();
    basic_hits_.resize(*device_, basic_rays());
    cast_basic();
    ray_contacts_.resize(*device_, rays_.size());
    ray_sides_.resize(*device_, rays_.size());
    find_contacts();
    if (contacts_.size() == 0) throw std::logic_error("the batch " + batch.name + " has no contacts to measure with");
}

void Pipeline::count_clusters() {
    const auto& shapes = store_.arrays();
    launch<KernelId::count_clusters>(*device_, pairs_.size(), pairs_, shapes.headers, shapes.clusters, pair_clusters_,
                                     small_);
}

void Pipeline::write_clusters() {
    const auto& shapes = store_.arrays();
    launch<KernelId::write_clusters>(*device_, pairs_.size(), pairs_, shapes.headers, shapes.clusters, small_,
                                     cluster_firsts_, clusters_);
}

void Pipeline::count_rays() {
    const auto& shapes = store_.arrays();
    launch<KernelId::count_rays>(*device_, clusters_.size(), 1u, pairs_, shapes.headers, shapes.vertex_blocks,
                                 shapes.outside_cells, shapes.clearances, clusters_, block_inside_, block_rays_);
}

void Pipeline::write_rays() {
    launch<KernelId::write_rays>(*device_, clusters_.size(), clusters_, ray_firsts_, rays_);
}

void Pipeline::cast_bvh() {
    const auto& shapes = store_.arrays();
    launch<KernelId::cast_rays_bvh>(*device_, rays_.size(), 0u, pairs_, shapes.headers, shapes.vertex_blocks,
                                    shapes.nodes, shapes.triangle_blocks, shapes.face_normals, rays_, hits_);
}

void Pipeline::cast_basic() {
    const auto& shapes = store_.arrays();
    launch<KernelId::cast_rays_basic>(*device_, basic_rays(), pairs_, shapes.headers, shapes.vertex_blocks,
                                      shapes.nodes, shapes.triangle_blocks, shapes.face_normals, rays_, basic_hits_);
}

std::size_t Pipeline::basic_rays() const {
    return std::min<std::size_t>(rays_.size(), 512);
}

void Pipeline::count_contacts() {
    launch<KernelId::count_contacts>(*device_, hits_.size(), hits_, ray_contacts_, ray_sides_);
}

void Pipeline::write_contacts() {
    const auto& shapes = store_.arrays();
    launch<KernelId::write_contacts>(*device_, hits_.size(), pairs_, shapes.headers, shapes.vertex_blocks,
                                     shapes.face_normals, rays_, hits_, contact_firsts_, contacts_);
}

void Pipeline::find_clusters() {
    count_clusters();
    clusters_.resize(*device_, scan_.run(*device_, pair_clusters_, cluster_firsts_));
    write_clusters();
    block_inside_.resize(*device_, clusters_.size());
    block_rays_.resize(*device_, clusters_.size());
}

void Pipeline::find_rays() {
    count_rays();
    rays_.resize(*device_, scan_.run(*device_, block_rays_, ray_firsts_));
    write_rays();
}

void Pipeline::find_contacts() {
    count_contacts();
    contacts_.resize(*device_, scan_.run(*device_, ray_contacts_, contact_firsts_));
    write_contacts();
}

std::vector<kernels::LocalContact> Pipeline::host_contacts() {
    return copy_of(*device_, contacts_);
}

} // namespace raycontact::bench
