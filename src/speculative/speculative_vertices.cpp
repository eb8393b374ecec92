// SPDX-License-Identifier: Apache-2.0
#include "speculative/speculative_vertices.h"

#include "speculative/speculative_pair.h"

#include <algorithm>
#include <numeric>

namespace raycontact {

namespace {

constexpr std::size_t pairs_in_block = 32;

} // namespace

void SpeculativeVertices::run(const Update& update, const ByPair<kernels::LocalContact>& touching,
                              std::span<const AskedPair> asked) {
    const std::size_t block_count = (asked.size() + pairs_in_block - 1) / pairs_in_block;
    if (blocks_.size() < block_count) blocks_.resize(block_count);
    ends_.assign(update.pairs.size() + 1, 0);
    update.executor.each(block_count, 1, [&](std::uint32_t k) {
        std::vector<FeatureContact>& block = blocks_[k];
        block.clear();
        const std::size_t first = k * pairs_in_block;
        for (const AskedPair& one : asked.subspan(first, std::min(pairs_in_block, asked.size() - first))) {
            const std::size_t before = block.size();
            const PlacedBody &a = update.bodies[update.pairs[one.pair].first],
                             &b = update.bodies[update.pairs[one.pair].second];
            find_speculative_vertices({a, b, speculative_margin(update.settings, a, b)}, {one.near[0], one.near[1]},
                                      {touching.of(2 * one.pair), touching.of(2 * one.pair + 1)}, block);
            ends_[one.pair + 1] = static_cast<std::uint32_t>(block.size() - before);
        }
    });
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    found_.clear();
    for (std::size_t k = 0; k < block_count; ++k) found_.insert(found_.end(), blocks_[k].begin(), blocks_[k].end());
}

void SpeculativeVertices::clear() {
    found_.clear();
    ends_.clear();
}

void SpeculativeVertices::give_back() {
    for (std::vector<FeatureContact>& block : blocks_) raycontact::give_back(block);
    raycontact::give_back(found_, ends_);
}

} // namespace raycontact
