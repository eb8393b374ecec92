// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/box_tree.h"
#include "pairs/open_pairs.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What a broad phase is asked about, by slots of bodies.
struct BroadPhaseInput {
    /// A body is in these groups, and meets those in its mask: both ways round.
    struct Filter {
        std::uint32_t groups = 1, mask = 0xffffffffu;
        bool is_static = false; ///< it meets nothing that is static, too
        bool operator==(const Filter&) const = default;
        bool lets_meet(const Filter& other) const { return lets_touch(other) && !(is_static && other.is_static); }
        bool lets_touch(const Filter& other) const { return (groups & other.mask) != 0 && (other.groups & mask) != 0; }
    };
    std::span<const Box> boxes; ///< no_box where there is no body
    std::span<const Filter> filters;

    bool is_pair(BodySlot a, BodySlot b) const {
        return boxes[a].touches(boxes[b]) && (filters.empty() || filters[a].lets_meet(filters[b]));
    }
};

/// Finds the pairs of boxes that touch. On all threads; no result depends on their number.
class BroadPhase {
public:
    /// All pairs whose boxes touch, and which no filter keeps apart, sorted; valid until the next call. tree: of the
    /// boxes as they are.
    std::span<const SlotPair> find(Executor& executor, BoxTree& tree, const BroadPhaseInput& input);
    /// These become `pairs`, which were those of the boxes before the ones in the slots of `changed`, each once, became
    /// others.
    void update(Executor& executor, BoxTree& tree, const BroadPhaseInput& input, std::span<const BodySlot> changed,
                OpenPairs& pairs);
    /// Frees memory that the next call makes anew.
    void trim();

private:
    static constexpr std::uint32_t width = BoxTree::width;
    /// By one thread.
    struct Found {
        std::vector<SlotPair> pairs;
        std::uint64_t tests = 0; ///< of nodes
    };
    /// What does not change while pairs are found.
    struct Question {
        const BoxTree& tree;
        const BroadPhaseInput& input;
    };

    template <class Work>
    void run(Executor& executor, std::size_t count, Work&& work);
    static void meet(Found& found, const Question& asked, std::uint32_t node);
    static void descend(Found& found, const Question& asked, std::uint32_t node, const BoxTree::Corner& low,
                        const BoxTree::Corner& high, std::size_t level, std::uint32_t at);
    static void test(Found& found, const Question& asked, std::uint32_t node, std::uint32_t other);
    void query(Found& found, const Question& asked, BodySlot body, std::size_t level, std::uint32_t at) const;
    void sort(Executor& executor, std::size_t slots);

    std::vector<Found> found_;
    std::vector<std::span<const SlotPair>> lists_; ///< of found_
    PairSorter<SlotPair> sorter_;
    std::vector<SlotPair> sorted_;
    std::uint64_t tests_when_sorted_ = 0, sorts_when_found_ = 0; ///< of a find(); BoxTree::sorts() then
    std::vector<char> is_changed_;                               ///< by slot
};

} // namespace raycontact
