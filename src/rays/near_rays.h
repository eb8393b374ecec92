// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/results.h"
#include "rays/block_search.h"
#include "rays/ray_batch.h"

namespace raycontact {

/// The edges of pairs that may cross faces, or the edges or vertices that come near, found and cast as rays are. In
/// float32, with a margin for what that could hide (find_near.h): some more than cross. Nothing waits.
class NearRays {
public:
    explicit NearRays(BlockSearch::Sources sources) : search_(sources), sources_(sources) {}
    BlockSearch::Sources sources() const { return sources_; }
    /// By directed pair, metres; each may be empty.
    struct Reach {
        const Array<float>&more, &ahead;           ///< beyond what is needed; beyond that, for clear() alone
        const Array<kernels::EdgeChoice>& choices; ///< of edges; empty: all alike
    };
    /// pairs: both directions of each pair side by side. next: the same at the next step, for edges that come near on
    /// their way there; may be empty.
    void cast(const Update& update, const Array<kernels::DirectedPair>& pairs, const Array<kernels::DirectedPair>& next,
              const Reach& reach, const RayBatch& batch);
    /// Of a cast with `ahead`, in memory that host and device share: how far directed pair p can move before an edge
    /// comes nearer than `more` that is not found, metres.
    double clear(std::size_t p, float ahead, float tolerance) {
        return search_.clear(p, horizons_.in_place()[p] - ahead, tolerance);
    }
    /// After the read, with its sums: false if anything had too little room: there is enough now, and cast() must run
    /// again.
    bool had_room(Device& device, const RayBatch& batch);
    /// In the order of the pairs.
    Results<kernels::NearEdge>& found() { return found_; }

    /// Instead of a cast: there is nothing to do in this step.
    void rest();
    std::uint64_t bytes() const;

private:
    RayBatch::Sum sum(RayBatch::Sum of_edges) const;

    BlockSearch search_;
    BlockSearch::Sources sources_;
    Array<float> margins_, horizons_, thrown_; ///< by directed pair
    Array<kernels::DirectedPair> half_way_;
    Array<kernels::Ray> rays_;
    Array<kernels::EdgeHits> hits_;
    Columns counts_; ///< by ray: faces
    Results<kernels::NearEdge> found_;
    std::size_t block_count_ = 0, ray_count_ = 0; ///< of the last cast
};

} // namespace raycontact
