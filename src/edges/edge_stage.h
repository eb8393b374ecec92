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
    /// Of what it keeps for the pairs, and of what it found in the last step.
    std::uint64_t bytes() const;
    /// After a step: frees memory that it hardly used.
    void give_back();

private:
    /// What some of the blocks are worked on in, one after the other.
    struct Workspace {
        NearSearch search;
        PairEdges edges;
        std::vector<FeatureContact> found;
    };
    /// Pairs that one thread takes at once, and what it finds.
    struct Block {
        NearLists::Slice lists;
        std::vector<Contact> contacts;   ///< sorted, pair by pair
        std::vector<std::uint32_t> ends; ///< of each pair's, in contacts
    };
    /// What the pairs of a step are asked with.
    struct Question {
        Direction direction;
        std::span<const PlacedBody> bodies;
        std::span<const SlotPair> pairs;
        std::span<const kernels::LocalContact> local;
        const Motion* motion;
    };
    void find(Workspace& work, const Question& question, std::size_t number);
    void find(Workspace& work, Block& block, const Question& question, std::size_t i,
              const std::array<std::span<const kernels::LocalContact>, 2>& vertices);
    void merge(std::span<const SlotPair> pairs, std::vector<Contact>& contacts);

    NearLists lists_;
    std::vector<Block> blocks_;
    std::size_t block_count_ = 0;       ///< of the last step
    std::vector<std::uint32_t> firsts_; ///< of each directed pair's contacts, in local
    std::vector<Contact> merged_;
    std::vector<Workspace> work_;
};

} // namespace raycontact
