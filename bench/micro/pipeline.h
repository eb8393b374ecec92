// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/micro/batch.h"

#include "device/scan.h"
#include "shape/shape_store.h"

#include <string_view>

namespace raycontact::bench {

/// Every kernel of a step on a fixed batch, each with arrays of its own, so that any of them can be run again by
/// itself. One thread of the CPU device, one instruction set.
class Pipeline {
public:
    /// Runs everything once. Throws InputError for an instruction set that this processor or build does not have.
    Pipeline(Executor& executor, std::string_view instruction_set, const Batch& batch);

    // The arrays of those before it are as the first run left them.
    void find_clusters();
    void find_rays();
    void cast_bvh();
    void cast_basic(); ///< of basic_rays() rays
    void find_contacts();

    std::size_t ordered_pairs() const { return pairs_.size(); }
    std::size_t vertex_blocks() const { return clusters_.size(); }
    std::size_t rays() const { return rays_.size(); }
    std::size_t basic_rays() const;
    std::size_t contacts() const { return contacts_.size(); }
    std::vector<kernels::LocalContact> host_contacts(); ///< a copy

private:
    void count_clusters();
    void write_clusters();
    void count_rays();
    void write_rays();
    void count_contacts();
    void write_contacts();

    std::unique_ptr<Device> device_;
    ShapeStore store_;
    Scan scan_;
    Array<kernels::OrderedPair> pairs_;
    Array<kernels::uint> pair_clusters_, cluster_firsts_;
    Array<kernels::ulong> small_;
    Array<kernels::Cluster> clusters_;
    Array<kernels::uint> block_inside_, block_rays_, ray_firsts_;
    Array<kernels::Ray> rays_;
    Array<kernels::Hit> hits_, basic_hits_;
    Array<kernels::uint> ray_contacts_, ray_sides_, contact_firsts_;
    Array<kernels::LocalContact> contacts_;
};

} // namespace raycontact::bench
