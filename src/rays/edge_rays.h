// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/results.h"
#include "rays/block_search.h"
#include "rays/ray_batch.h"

namespace raycontact {

/// The edges of pairs that may cross faces, found and cast as rays are. In float32, with a margin for what that could
/// hide (find_edges.h): some more than cross. Nothing waits.
class EdgeRays {
public:
    /// pairs: both directions of each pair side by side. more: by pair, metres beyond what is needed. least: by pair,
    /// metres; shorter edges are left out. Either may be empty.
    void cast(const Update& update, const Array<kernels::DirectedPair>& pairs, const Array<float>& more,
              const Array<float>& least, const RayBatch& batch);
    /// After the read, with its sums: false if anything had too little room: there is enough now, and cast() must run
    /// again.
    bool had_room(Device& device, const RayBatch& batch);
    /// In the order of the pairs.
    Results<kernels::NearEdge>& found() { return found_; }

    /// Instead of a cast: there is nothing to do in this step.
    void rest();
    std::uint64_t bytes() const;
    /// After a step: frees memory that it hardly used.
    void give_back();

private:
    BlockSearch search_{BlockSearch::Sources::edges};
    Array<float> margins_; ///< by directed pair
    Array<kernels::Ray> rays_;
    Array<kernels::EdgeHits> hits_;
    Columns counts_; ///< by ray: faces
    Results<kernels::NearEdge> found_;
    std::size_t block_count_ = 0, ray_count_ = 0; ///< of the last cast
};

} // namespace raycontact
