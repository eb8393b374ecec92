// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "pairs/update.h"

#include <array>

namespace raycontact {

/// Finds the vertex blocks of pairs that may be in contact, and then the vertices of these blocks that cast a ray; or
/// the same of edges. Both are in the order of the pairs.
class BlockSearch {
public:
    /// Vertices that cast; edges, of pairs of which a body has an inside; vertices as points.
    enum class Sources : kernels::uint { vertices, edges, points };
    explicit BlockSearch(Sources sources = Sources::vertices) : sources_(sources) {}

    /// The blocks of all pairs that reach into the bounds; horizons as below. choices: of edges, with horizons,
    /// by pair, as far as whole blocks are alike; may be empty. Does not wait: totals[at] says on the device how many
    /// there are. If they have too little room, none is written (had_room()).
    void find(const Update& update, const Array<kernels::DirectedPair>& pairs, const Array<float>& horizons,
              const Array<kernels::EdgeChoice>& choices, const Array<kernels::Totals>& totals, std::size_t at);
    /// The blocks of the first pair_count pairs that reach into the bounds and, if there are horizons, could be in
    /// contact before they have moved by horizons[p] (metres, rounding included). Uses totals[at]. Waits for the device
    /// once, and makes as much room as the blocks need.
    void find_now(const Update& update, const Array<kernels::DirectedPair>& pairs, std::size_t pair_count,
                  const Array<float>& horizons, const Array<kernels::Totals>& totals, std::size_t at);
    /// sum: of the last find(). False if its blocks had too little room: there is enough now.
    bool had_room(Device& device, const kernels::Totals& sum);

    /// Counts the vertices of the blocks that cast a ray: those inside the bounds but, if use_grid, those that a grid
    /// of the target knows to be outside. totals[at]: rays, of which `room` can be written; vertices inside the bounds.
    void count_rays(const Update& update, const Array<kernels::DirectedPair>& pairs, bool use_grid,
                    const Array<kernels::Totals>& totals, std::size_t at, std::size_t room);
    /// Counts the edges, or points, of the blocks that come within margins[p] metres of the bounds and, for all that
    /// the grid knows, of a face. totals[at]: their number, of which `room` can be written. next: where the pairs will
    /// be at the next step; if empty they stay. ahead: of which pairs clear() will be asked, and up to how far; may be
    /// empty.
    void count_edges(const Update& update, const Array<kernels::DirectedPair>& pairs,
                     const Array<kernels::DirectedPair>& next, const Array<float>& thrown, const Array<float>& margins,
                     const Array<kernels::EdgeChoice>& choices, const Array<float>& ahead,
                     const Array<kernels::Totals>& totals, std::size_t at, std::size_t room);
    /// Of edges, in memory that host and device share: how far pair p can move before one that is not cast comes within
    /// its margin, metres; margin: with half the way to the next step.
    double clear(std::size_t p, float margin, float tolerance);
    /// Writes them, the first to rays[begin]. totals[at]: what was left there by the call that counted them.
    void write_rays(const Update& update, const Array<kernels::Totals>& totals, std::size_t at, kernels::uint begin,
                    const Array<kernels::Ray>& rays) const;

    /// Instead of a search: there are no pairs in this step.
    void rest() {
        pair_count_ = 0;
        found_ = Count(0);
    }
    static std::uint64_t bytes(std::uint64_t blocks, std::uint64_t pairs) {
        return blocks * (sizeof(kernels::PairBlock) + 3 * sizeof(kernels::uint))
               + pairs * (2 * sizeof(kernels::uint) + MASK_WORDS * sizeof(kernels::ulong) + sizeof(float));
    }
    /// Of the last find.
    std::uint64_t bytes() const { return bytes(found_.most, pair_count_); }

    /// Blocks of the last find; of find(), as the device has counted them.
    const Count& found() const { return found_; }
    /// As many as find_now() found; of find(): the room.
    const Array<kernels::PairBlock>& blocks() const { return blocks_; }
    /// By pair: where its blocks begin.
    const Array<kernels::uint>& firsts() const { return counts_.firsts(); }
    /// Of find_now(), by pair: how many blocks it has.
    std::span<const kernels::uint> host_counts() const { return host_counts_; }
    /// Of find_now() with horizons, by pair, if it has no block: how far its vertices can move before one could be in
    /// contact, metres, rounding not included. May be less, also negative.
    std::span<const float> host_safe_distances() const { return host_safe_distances_; }

    /// Arguments of a read: of find(), what host_counts() and host_safe_distances() say after a find_now().
    std::array<Piece, 2> results() {
        host_counts_.resize(pair_count_);
        host_safe_distances_.resize(safe_distances_.size());
        return {counts_.values().piece(host_counts_), safe_distances_.piece(host_safe_distances_)};
    }

    /// By block: a column of vertices that cast, one of those inside the bounds; 0 until they are counted.
    Columns& ray_counts() { return ray_counts_; }

private:
    void make_room(Device& device, std::size_t blocks);
    void count(const Update& update, const Array<kernels::DirectedPair>& pairs, std::size_t pair_count,
               const Array<float>& horizons, const Array<kernels::EdgeChoice>& choices,
               const Array<kernels::Totals>& totals, std::size_t at, std::size_t room);
    void write(const Update& update, const Array<kernels::DirectedPair>& pairs, const Count& items,
               const Array<float>& horizons, const Array<kernels::EdgeChoice>& choices) const;

    Sources sources_;
    Columns counts_, ray_counts_;
    Array<float> safe_distances_;
    Array<kernels::ulong> block_masks_; ///< by pair: for a source of few blocks those found, a bit each, MASK_WORDS
    Array<kernels::PairBlock> blocks_;
    Count found_{0}; ///< of blocks_
    std::size_t pair_count_ = 0;
    std::vector<kernels::uint> host_counts_;
    std::vector<float> host_safe_distances_;
};

} // namespace raycontact
