// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/near_edges.h"
#include "pairs/displacement.h"
#include "pairs/motion.h"
#include "pairs/pair_table.h"
#include "pairs/range_pool.h"

#include <raycontact/settings.h>

#include <span>
#include <vector>

namespace raycontact {

/// Whether edges go on with what was near in the last steps. The other methods ask every pair in full.
inline bool keeps_near_lists(const Settings& settings) {
    return settings.features == Features::edges && settings.method == Method::certified;
}

/// The near edges of each open pair, sought some way beyond what is needed and kept until the pair has moved that
/// far. So most pairs walk no tree in a step, and pairs that are apart are not looked at. What is found with them is
/// the same as without.
class NearLists {
public:
    /// What one thread finds.
    class Slice {
    public:
        void clear();
        std::uint64_t bytes() const { return near_.capacity() * sizeof(NearEdge) + fresh_.capacity() * sizeof(Fresh); }
        /// After a step: frees memory that it hardly used.
        void give_back();
        /// The near edges of a pair, without a list; valid until the next call.
        NearEdges find(NearSearch& search, const std::array<SourceMesh, 2>& placed, double margin = 0);

    private:
        friend class NearLists;
        struct Fresh {
            std::size_t pair, first; ///< place of the pair in the step; of its list in near_
        };
        std::vector<NearEdge> near_;
        std::vector<Fresh> fresh_;
    };

    /// First in a step, with the pairs of the step.
    void match(std::span<const SlotPair> pairs);
    /// Once a step for each pair, before what follows; for different pairs at the same time, if need be.
    void move(std::size_t i, const SlotPair& pair, const Motion& motion) {
        table_.hot(i).metres -= motion.pair_bound(pair);
    }
    /// Whether the i-th pair is known to be apart: no edge crosses a face, and neither body is inside the other.
    bool is_apart(std::size_t i) { return table_.hot(i).apart && table_.hot(i).metres > 0; }
    /// The near edges of the i-th pair; valid until the slice's next call.
    NearEdges near(std::size_t i, const SlotPair& pair, std::span<const PlacedBody> bodies,
                   const std::array<SourceMesh, 2>& placed, const Motion& motion, NearSearch& search, Slice& slice);
    /// In this step, after near(): the i-th pair is apart. It stays so while its list is valid, if that is empty.
    void found_apart(std::size_t i);
    /// Last in a step: keeps what a slice found.
    void keep(const Slice& slice);

    void clear();
    std::uint64_t bytes() const { return table_.bytes() + pool_.in_use() * sizeof(NearEdge); }

private:
    struct List {
        PairPlace reference; ///< at which it was made
        double margin = 0;   ///< metres beyond what is needed
        bool known = false;  ///< it was made
        std::uint32_t first = 0, capacity = 0;
        std::array<std::uint32_t, 2> counts{}; ///< of edges of a, of b
        std::uint32_t count() const { return counts[0] + counts[1]; }
    };
    /// What is read for every pair in every step.
    struct Slack {
        double metres = -1; ///< that the pair may move, by the cheap bound, before the exact one is computed
        bool apart = false; ///< while the list is valid
    };

    PairTable<List, Slack> table_;
    RangePool pool_;
    std::vector<NearEdge> lists_;
};

} // namespace raycontact
