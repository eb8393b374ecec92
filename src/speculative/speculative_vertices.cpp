// SPDX-License-Identifier: Apache-2.0
#include "speculative/speculative_vertices.h"

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
        auto& [found, touches, search] = blocks_[k];
        found.clear();
        const std::size_t first = k * pairs_in_block;
        for (const AskedPair& one : asked.subspan(first, std::min(pairs_in_block, asked.size() - first))) {
            const std::size_t before = found.size();
            const PlacedBody &a = update.bodies[update.pairs[one.pair].first],
                             &b = update.bodies[update.pairs[one.pair].second];
            for (std::size_t side = 0; side < 2; ++side) {
                const auto local = touching.of(2 * one.pair + side);
                touches[side].assign(local.begin(), local.end());
                std::ranges::sort(touches[side], {}, &kernels::LocalContact::vertex);
            }
            search.find({a, b, speculative_margin(update.settings, a, b)}, {one.near[0], one.near[1]},
                        {touches[0], touches[1]}, found);
            ends_[one.pair + 1] = static_cast<std::uint32_t>(found.size() - before);
        }
    });
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    found_.clear();
    for (std::size_t k = 0; k < block_count; ++k)
        found_.insert(found_.end(), blocks_[k].found.begin(), blocks_[k].found.end());
}

void SpeculativeVertices::clear() {
    found_.clear();
    ends_.clear();
}

} // namespace raycontact
