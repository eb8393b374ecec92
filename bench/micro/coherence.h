// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/micro/batch.h"

#include "device/scan.h"
#include "shape/shape_store.h"

#include <raycontact/settings.h>

#include <string_view>
#include <vector>

namespace raycontact::bench {

/// The kernels of the methods that keep something from step to step, on a fixed batch and on the same batch moved a
/// little; as Pipeline otherwise.
class Coherence {
public:
    /// Runs everything once. Throws InputError for an instruction set that this processor or build does not have.
    Coherence(Executor& executor, std::string_view instruction_set, const Batch& batch);

    // One kernel each.
    void count_near_clusters();
    void write_near_clusters();
    void count_near_rays();
    void write_near_rays();
    void cast_near_rays(Caster caster); ///< no walk: in full or ahead alone; of basic_rays() rays with `basic`
    void walk();                        ///< what the casts met, from there, at the moved poses
    void begin_watches();
    void look_at_watches(); ///< at all of them: their clock is ahead of every certificate
    void write_watch_rays();
    void seek_tubes();  ///< rays of the watches, cast in full, and the tube around each
    void decide_held(); ///< the same rays at the same poses, by the triangle of each tube

    // As a step strings them together.
    void find_near_rays();
    void find_watch_rays();

    std::size_t pairs() const { return wide_.size(); }
    std::size_t vertex_blocks() const { return clusters_.size(); }
    std::size_t near_rays() const { return rays_.size(); }
    std::size_t basic_rays() const;
    std::size_t walks() const { return walk_rays_.size(); }
    std::size_t watch_rays() const { return watch_rays_.size(); }

private:
    void hold(const Array<kernels::Holder>& holders, const Array<kernels::Held>& before, Array<kernels::Held>& after);
    void follow(Caster caster, std::size_t count, const Array<kernels::OrderedPair>& pairs,
                const Array<kernels::Ray>& rays, const Array<kernels::uint>& starts, Array<kernels::Hit>& hits,
                Array<kernels::uint>& nexts, Array<kernels::uint>& hows);

    std::unique_ptr<Device> device_;
    ShapeStore store_;
    Scan scan_;
    Array<kernels::OrderedPair> pairs_, wide_, moved_;
    Array<float> cullings_, reaches_, margins_, clears_;
    Array<kernels::uint> pair_clusters_, cluster_firsts_, block_inside_, block_rays_, ray_firsts_;
    Array<kernels::ulong> small_;
    Array<kernels::Cluster> clusters_, watch_clusters_;
    Array<kernels::Ray> rays_, walk_rays_, watch_rays_;
    Array<kernels::uint> starts_, nexts_, hows_, basic_nexts_, basic_hows_;
    Array<kernels::uint> walk_starts_, walk_nexts_, walk_hows_;
    Array<kernels::Hit> hits_, basic_hits_, walk_hits_;
    Array<kernels::Segment> segments_;
    Array<kernels::Watch> watches_;
    Array<kernels::Look> looks_;
    Array<kernels::uint> segment_rays_, segment_firsts_;
    Array<kernels::Holder> seekers_, holders_;
    Array<kernels::Held> held_, held_again_;
    Array<kernels::Hit> held_hits_;
    Array<kernels::uint> held_casts_;
};

} // namespace raycontact::bench
