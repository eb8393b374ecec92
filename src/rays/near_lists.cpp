// SPDX-License-Identifier: Apache-2.0
#include "rays/near_lists.h"

#include "free_all.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <functional>

namespace raycontact {

namespace {

// For all pairs of a first step the search would take as much memory as all that is kept.
constexpr std::size_t pairs_at_once = 1 << 13;

} // namespace

void NearLists::clear() {
    pool_.clear();
    free_all(edges_);
}

void NearLists::find(const Update& update, std::span<const Search> due, CertifiedPairs& table, RayBatch& batch) {
    if (due.empty()) {
        resize(update.device, 0, pairs_, next_, margins_, ahead_, choices_);
        found_.set(update.executor, {}, std::identity(), 0);
        return rays_.rest();
    }
    for (std::size_t first = 0; first < due.size(); first += pairs_at_once)
        find_some(update, due.subspan(first, std::min(pairs_at_once, due.size() - first)), table, batch);
}

void NearLists::find_some(const Update& update, std::span<const Search> due, CertifiedPairs& table, RayBatch& batch) {
    const bool move = std::ranges::any_of(due, &Search::moves);
    resize(update.device, 2 * due.size(), pairs_, margins_, ahead_, choices_);
    next_.resize(update.device, move ? pairs_.size() : 0);
    const bool points = kept_ == &CertifiedPair::points;
    update.executor.each(due.size(), 128, [&](std::uint32_t k) {
        for (std::uint32_t side = 0; side < 2; ++side) {
            const auto [source, target] = directed_bodies(update.bodies, update.pairs, 2 * due[k].pair + side);
            place_source(source, target, pairs_.in_place()[2 * k + side]);
            if (due[k].moves && (side == 0 || points))
                place_source(source, target, relative_pose(target.next, source.next), next_.in_place()[2 * k + side]);
            else if (move)
                next_.in_place()[2 * k + side] = pairs_.in_place()[2 * k + side];
            const bool is_ahead = side == 0 || points || due[k].least_ahead > 0;
            margins_.in_place()[2 * k + side] = due[k].margin + (is_ahead ? due[k].speculative : 0);
            ahead_.in_place()[2 * k + side] = due[k].ahead;
            choices_.in_place()[2 * k + side] = {due[k].least, due[k].least_ahead, due[k].speculative};
        }
    });
    do {
        rays_.cast(update, pairs_, next_, {margins_, ahead_, choices_}, batch);
        const Piece pieces[] = {batch.totals.piece(batch.sums), rays_.found().piece()};
        update.device.queue().read(pieces);
        check_sums(batch.sums);
    } while (!rays_.had_room(update.device, batch));
    found_.set(update.executor, rays_.found().values(), std::identity(), due.size());
    for (std::size_t k = 0; k < due.size(); ++k) {
        const auto [a, b] = update.pairs[due[k].pair];
        const double clear = std::min(
            {double(due[k].ahead), rays_.clear(2 * k, due[k].ahead, update.bodies[b].shape->data().header.tolerance),
             rays_.clear(2 * k + 1, due[k].ahead, update.bodies[a].shape->data().header.tolerance)});
        table.hot(due[k].pair).*slack_ = edge_share * (double(due[k].margin) + clear);
        CertifiedPair& pair = table.state(due[k].pair);
        release(pair);
        KeptNear& kept = pair.*kept_;
        kept.counts = {static_cast<std::uint32_t>(found_.of(2 * k).size()),
                       static_cast<std::uint32_t>(found_.of(2 * k + 1).size())};
        // Each source is asked in every step. Back to the whole reach it takes some thirty steps.
        constexpr std::uint32_t much = 256;
        const bool in_vain = due[k].is_wide && kept.count() > much;
        kept.reach = in_vain ? due[k].reach / 16 : std::min(1.1f * due[k].reach, 1.0f);
        const RangePool::Range range = pool_.allocate(kept.count());
        kept.first = range.first;
        kept.capacity = range.capacity;
        if (edges_.size() < pool_.end()) edges_.resize(pool_.end());
        const auto all = found_.all().subspan(found_.first(2 * k), kept.count());
        std::copy(all.begin(), all.end(), edges_.begin() + std::ptrdiff_t(kept.first));
    }
}

std::uint64_t NearLists::bytes() const {
    return edges_.capacity() * sizeof(kernels::NearEdge) + rays_.bytes() + found_.all().size_bytes()
           + next_.size() * sizeof(kernels::DirectedPair)
           + pairs_.size() * (sizeof(kernels::DirectedPair) + 2 * sizeof(float) + sizeof(kernels::EdgeChoice));
}

void NearLists::trim() {
    free_all(pairs_, next_, margins_, ahead_, choices_, found_);
    rays_ = NearRays(rays_.sources());
}

} // namespace raycontact
