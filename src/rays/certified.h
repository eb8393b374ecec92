// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/motion.h"
#include "pairs/pair_table.h"
#include "pairs/range_pool.h"
#include "rays/ray_queue.h"

#include <optional>

namespace raycontact {

/// The rays of a step by the certified method: those of `standard` that could be contacts, and hardly any other
/// (docs/certified.md). Each ordered pair watches the vertex blocks within some distance of its target; a block, and a
/// pair, sleeps until the pair has moved as far as the nearest vertex was from touching.
class CertifiedRays {
public:
    /// threshold: metres that a list of blocks reaches beyond the bounds; empty: chosen by the pair's speed and size.
    void fill(Device& device, Executor& executor, const ShapeStore& shapes, std::span<const PlacedBody> bodies,
              std::span<const Pair> pairs, const Motion& motion, std::optional<double> threshold);
    void clear();

    const Array<kernels::OrderedPair>& pairs() const { return device_pairs_; }
    const Array<kernels::Ray>& rays() const { return rays_; }
    /// 2 x pair + direction of each of pairs(), ascending.
    std::span<const std::uint32_t> ordered() const { return active_; }

    std::uint64_t vertices_inside() const { return inside_; }
    std::uint64_t vertices_tested() const { return VERTEX_LANES * blocks_; }
    std::uint64_t full_looks() const { return stale_.size(); }
    std::uint64_t bytes() const { return table_.bytes() + pool_.in_use() * sizeof(kernels::Watch); }

private:
    void wake_up(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pair> pairs,
                 const Motion& motion, std::optional<double> threshold);
    void make_lists(Device& device, const ShapeStore& shapes);
    void look(Device& device, const ShapeStore& shapes);
    DirectedState& directed(std::uint32_t ordered) { return table_.state(ordered / 2).directed[ordered % 2]; }

    PairTable table_;
    RangePool pool_;
    Scan scan_;
    std::vector<std::uint8_t> due_;             ///< per pair: bits 0, 1 look; bits 2, 3 make a new list
    std::vector<std::uint32_t> active_, stale_; ///< ordered pairs; stale_ are places in active_
    std::vector<kernels::OrderedPair> host_pairs_, wide_pairs_;
    std::vector<float> margins_, stale_margins_; ///< of active_, of stale_
    std::vector<kernels::uint> host_counts_, places_;
    std::vector<kernels::Segment> host_segments_;
    std::vector<kernels::Look> host_looks_;
    std::uint64_t inside_ = 0, blocks_ = 0, packed_ = 0;

    Array<kernels::OrderedPair> device_pairs_, device_wide_;
    Array<kernels::uint> counts_, firsts_, device_places_;
    Array<float> device_margins_;
    Array<kernels::ulong> small_;
    Array<kernels::Cluster> clusters_;
    Array<kernels::Watch> watches_;
    Array<kernels::Segment> segments_;
    Array<kernels::Look> looks_;
    Array<kernels::Ray> rays_;
};

} // namespace raycontact
