// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/inside.h"
#include "edges/near_lists.h"
#include "edges/pair_edges.h"
#include "executor/executor.h"

#include <raycontact/settings.h>

#include <span>
#include <vector>

namespace raycontact {

/// Adds the contacts of edges, and of bodies inside others, to those of the vertices (docs/edges.md). It works on the
/// host, in double, for every device: so its contacts are the same for all.
class EdgeStage {
public:
    /// local: the vertex contacts in the order of their directed pairs. contacts: the same, placed and sorted; the new
    /// ones are sorted in. motion: of this step, to go on with what was found in the last ones; null: every pair is
    /// asked in full.
    void run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
             std::span<const SlotPair> pairs, std::span<const kernels::LocalContact> local, const Motion* motion,
             std::vector<Contact>& contacts);
    /// Forgets what it kept for the next step.
    void forget() { lists_.clear(); }
    /// Of what it keeps for the pairs.
    std::uint64_t bytes() const { return lists_.bytes(); }

private:
    /// Pairs that one thread takes at once, and what it finds.
    struct Block {
        PairEdges edges;
        NearLists::Slice lists;
        std::vector<FeatureContact> found;
        std::vector<Contact> contacts;   ///< sorted, pair by pair
        std::vector<std::uint32_t> ends; ///< of each pair's, in contacts
    };
    /// What the pairs of a step are asked with.
    struct Question {
        Direction direction;
        std::span<const PlacedBody> bodies;
        std::span<const SlotPair> pairs;
        const Motion* motion;
    };
    void find(Block& block, const Question& question, std::size_t i,
              const std::array<std::span<const kernels::LocalContact>, 2>& vertices);
    void merge(std::span<const SlotPair> pairs, std::vector<Contact>& contacts);

    NearLists lists_;
    std::vector<Block> blocks_;
    std::vector<std::uint32_t> firsts_; ///< of each directed pair's contacts, in local
    std::vector<Contact> merged_;
};

} // namespace raycontact
