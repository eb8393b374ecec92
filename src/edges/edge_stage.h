// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/place.h"
#include "edges/pair_edges.h"
#include "pairs/by_pair.h"
#include "pairs/near_edges.h"
#include "pairs/update.h"
#include "speculative/edge_search.h"
#include "speculative/speculative_vertices.h"

#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// Finds the contacts of edges, of bodies inside others (docs/internals/edges.md), and of what does not touch yet
/// (docs/internals/speculative.md). It works on the host, in double, for every device: so its contacts are the same for
/// all.
class EdgeStage {
public:
    /// local: the vertex contacts; speculative: those that do not touch yet. asked: in the order of the pairs.
    void run(const Update& update, const ByPair<kernels::LocalContact>& local, const SpeculativeVertices& speculative,
             std::span<const AskedPair> asked);
    /// What it found in the last step, in the order of the pairs.
    std::span<const PlacedContacts> found() const { return found_; }
    std::uint64_t bytes() const;

private:
    /// What some of the blocks are worked on in, one after the other.
    struct Workspace {
        PairEdges edges;
        std::vector<FeatureContact> found, ahead; ///< of one pair; those of vertices that do not touch yet
    };
    /// Pairs that one thread takes at once, and what it finds.
    struct Block {
        std::vector<Contact> contacts;                           ///< sorted, pair by pair
        std::vector<std::pair<std::uint32_t, std::size_t>> ends; ///< pairs that have some, and where theirs end
        std::size_t first_pair, first_contact;                   ///< among all
    };
    /// What the pairs of a step are asked with.
    struct Question {
        const Update& update;
        const ByPair<kernels::LocalContact>& local;
        const SpeculativeVertices& speculative;
        std::span<const AskedPair> asked;
    };
    void find(Workspace& work, const Question& question, std::size_t number);
    void find(Workspace& work, Block& block, const Question& question, const AskedPair& asked);
    void list_found(Executor& executor);

    std::vector<Block> blocks_;
    std::size_t block_count_ = 0; ///< of the last step
    std::vector<PlacedContacts> found_;
    std::vector<Workspace> work_;
};

} // namespace raycontact
