// SPDX-License-Identifier: Apache-2.0
#include "rays/block_search.h"

#include "device/launch.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::size_t least_room = 4096; // blocks

} // namespace

void BlockSearch::make_room(Device& device, std::size_t blocks) {
    static_cast<void>(Count(VERTEX_LANES * blocks)); // a GPU's items are vertices
    blocks_.resize(device, blocks);
    ray_counts_.resize(device, 2, blocks);
}

void BlockSearch::count(const Update& update, const Array<kernels::DirectedPair>& pairs, std::size_t pair_count,
                        const Array<float>& horizons, const Array<kernels::EdgeChoice>& choices,
                        const Array<kernels::Totals>& totals, std::size_t at, std::size_t room) {
    const ShapeStore::Arrays& arrays = update.arrays();
    pair_count_ = pair_count;
    counts_.resize(update.device, 1, pair_count);
    block_masks_.resize(update.device, MASK_WORDS * pair_count);
    safe_distances_.resize(update.device, horizons.size());
    launch<KernelId::count_clusters>(update.device, pair_count, static_cast<kernels::uint>(sources_), pairs, horizons,
                                     choices, arrays.headers, arrays.memory, counts_.values(), safe_distances_,
                                     block_masks_);
    counts_.scan(update.device, pair_count, totals, at, room);
}

void BlockSearch::write(const Update& update, const Array<kernels::DirectedPair>& pairs, const Count& items,
                        const Array<float>& horizons, const Array<kernels::EdgeChoice>& choices) const {
    const ShapeStore::Arrays& arrays = update.arrays();
    launch<KernelId::write_clusters>(update.device, items, static_cast<kernels::uint>(sources_), pairs, horizons,
                                     choices, arrays.headers, arrays.memory, block_masks_, counts_.firsts(), blocks_,
                                     ray_counts_.stride(), ray_counts_.values());
}

void BlockSearch::find(const Update& update, const Array<kernels::DirectedPair>& pairs, const Array<float>& horizons,
                       const Array<kernels::EdgeChoice>& choices, const Array<kernels::Totals>& totals,
                       std::size_t at) {
    make_room(update.device, std::max(blocks_.size(), least_room));
    count(update, pairs, pairs.size(), horizons, choices, totals, at, blocks_.size());
    write(update, pairs, items_of(totals, at, pairs.size()), horizons, choices);
    found_ = results_of(totals, at, blocks_.size());
}

void BlockSearch::find_now(const Update& update, const Array<kernels::DirectedPair>& pairs, std::size_t pair_count,
                           const Array<float>& horizons, const Array<kernels::Totals>& totals, std::size_t at) {
    host_counts_.resize(pair_count);
    host_safe_distances_.resize(horizons.size());
    kernels::Totals sum{};
    pair_count_ = pair_count;
    if (pair_count > 0) {
        count(update, pairs, pair_count, horizons, {}, totals, at, NONE - 1);
        const Piece pieces[] = {totals.piece({&sum, 1}, at), counts_.values().piece(host_counts_),
                                safe_distances_.piece(host_safe_distances_)};
        update.device.queue().read(pieces);
        check_sums({&sum, 1});
    }
    make_room(update.device, sum.results);
    found_ = Count(sum.results);
    write(update, pairs, sum.items, horizons, {});
}

bool BlockSearch::had_room(Device& device, const kernels::Totals& sum) {
    const bool fits = sum.sums[0] <= blocks_.size();
    if (!fits) make_room(device, std::size_t{sum.sums[0]} + sum.sums[0] / 2); // the next step may have a few more
    return fits;
}

void BlockSearch::count_rays(const Update& update, const Array<kernels::DirectedPair>& pairs, bool use_grid,
                             const Array<kernels::Totals>& totals, std::size_t at, std::size_t room) {
    const ShapeStore::Arrays& arrays = update.arrays();
    launch<KernelId::count_rays>(update.device, found_, use_grid ? 1u : 0u, ray_counts_.stride(), pairs, arrays.headers,
                                 arrays.memory, blocks_, ray_counts_.values());
    ray_counts_.scan(update.device, found_, totals, at, room);
}

void BlockSearch::count_edges(const Update& update, const Array<kernels::DirectedPair>& pairs,
                              const Array<kernels::DirectedPair>& next, const Array<float>& thrown,
                              const Array<float>& margins, const Array<kernels::EdgeChoice>& choices,
                              const Array<float>& ahead, const Array<kernels::Totals>& totals, std::size_t at,
                              std::size_t room) {
    const ShapeStore::Arrays& arrays = update.arrays();
    launch<KernelId::count_edges>(update.device, found_, sources_ == Sources::points ? 1u : 0u, pairs, next, thrown,
                                  margins, choices, ahead, arrays.headers, arrays.memory, blocks_,
                                  ray_counts_.values());
    ray_counts_.scan(update.device, found_, totals, at, room);
}

double BlockSearch::clear(std::size_t p, float margin, float tolerance) {
    kernels::uint steps = NONE;
    const auto own = blocks_.in_place().subspan(counts_.firsts().in_place()[p], counts_.values().in_place()[p]);
    for (const kernels::PairBlock& block : own) steps = std::min(steps, block.clear);
    return std::min(double(safe_distances_.in_place()[p]) - double(margin), double(steps) * double(tolerance));
}

void BlockSearch::write_rays(const Update& update, const Array<kernels::Totals>& totals, std::size_t at,
                             kernels::uint begin, const Array<kernels::Ray>& rays) const {
    launch<KernelId::write_rays>(update.device, items_of(totals, at, found_.most), begin, blocks_, ray_counts_.firsts(),
                                 rays);
}

} // namespace raycontact
