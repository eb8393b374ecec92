// SPDX-License-Identifier: Apache-2.0
#include "rays/edge_lists.h"

#include "give_back.h"

#include <algorithm>
#include <numeric>

namespace raycontact {

void EdgeLists::clear() {
    pool_.clear();
    free_all(edges_);
}

void EdgeLists::find(const Update& update, std::span<const WakeUp::Slice> slices, WatchedPairs& table,
                     RayBatch& batch) {
    due_.clear();
    for (const WakeUp::Slice& slice : slices)
        for (const DueEdges& due : slice.edges) due_.push_back(due.pair);
    if (due_.empty()) return;
    pairs_.resize(update.device, 2 * due_.size());
    margins_.resize(update.device, 2 * due_.size());
    directed_.resize(2 * due_.size());
    std::iota(directed_.begin(), directed_.end(), 0U);
    std::size_t at = 0;
    for (const WakeUp::Slice& slice : slices)
        for (const DueEdges& due : slice.edges)
            for (const kernels::DirectedPair& place : due.places) {
                pairs_.in_place()[at] = place;
                margins_.in_place()[at++] = due.margin;
            }
    do {
        rays_.cast(update, pairs_, margins_, batch);
        const Piece pieces[] = {batch.totals.piece(batch.sums), rays_.found().piece()};
        update.device.queue().read(pieces);
        check_sums(batch.sums);
    } while (!rays_.had_room(update.device, batch));
    found_.set(rays_.found().values(), directed_, due_.size());
    for (std::size_t k = 0; k < due_.size(); ++k) {
        KeptEdges& kept = table.state(due_[k]).edges;
        release(kept);
        const std::array counts{static_cast<std::uint32_t>(found_.of(2 * k).size()),
                                static_cast<std::uint32_t>(found_.of(2 * k + 1).size())};
        const RangePool::Range range = pool_.allocate(counts[0] + counts[1]);
        kept = {range.first, range.capacity, counts};
        if (edges_.size() < pool_.end()) edges_.resize(pool_.end());
        const auto all = found_.all().subspan(found_.first(2 * k), kept.count());
        std::copy(all.begin(), all.end(), edges_.begin() + std::ptrdiff_t(kept.first));
    }
}

std::uint64_t EdgeLists::bytes(const RayBatch& batch) const {
    return pool_.in_use() * sizeof(kernels::NearEdge)
           + (due_.empty() ? 0 : rays_.bytes(batch) + found_.all().size_bytes());
}

void EdgeLists::give_back(const RayBatch& batch) {
    raycontact::give_back(due_);
    raycontact::give_back(directed_);
    pairs_.give_back();
    margins_.give_back();
    rays_.give_back(batch);
    found_.give_back();
}

} // namespace raycontact
