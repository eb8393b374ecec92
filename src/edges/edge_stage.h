// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/by_pair.h"
#include "edges/inside.h"
#include "edges/near_lists.h"
#include "edges/pair_edges.h"
#include "pairs/update.h"

#include <span>
#include <vector>

namespace raycontact {

/// Adds the contacts of edges, and of bodies inside others, to those of the vertices (docs/edges.md). It works on the
/// host, in double, for every device: so its contacts are the same for all.
class EdgeStage {
public:
    /// local: the vertex contacts. near: the edges that may cross faces; null: they are sought here. contacts: those of
    /// vertices, placed and sorted; the new ones are sorted in. motion: of this step, to go on with what was found in
    /// the last ones; null: every pair is asked in full.
    void run(const Update& update, const ByPair<kernels::LocalContact>& local, const ByPair<kernels::NearEdge>* near,
             const Motion* motion, std::vector<Contact>& contacts);
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
        std::array<std::vector<NearEdge>, 2> near; ///< of a, of b
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
        const Update& update;
        const ByPair<kernels::LocalContact>& local;
        const ByPair<kernels::NearEdge>* near;
        const Motion* motion;
    };
    void find(Workspace& work, const Question& question, std::size_t number);
    void find(Workspace& work, Block& block, const Question& question, std::size_t i);
    void merge(const ByPair<kernels::LocalContact>& local, std::size_t pair_count, std::vector<Contact>& contacts);

    NearLists lists_;
    std::vector<Block> blocks_;
    std::size_t block_count_ = 0; ///< of the last step
    std::vector<Contact> merged_;
    std::vector<Workspace> work_;
};

} // namespace raycontact
