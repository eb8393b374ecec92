// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/world_box.h"
#include "executor/executor.h"
#include "slot_pair.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// What a broad phase is asked about, by slots of bodies.
struct BroadPhaseInput {
    /// A body is in these groups, and meets those in its mask: both ways round.
    struct Filter {
        std::uint32_t groups = 1, mask = 0xffffffffu;
        bool lets_meet(const Filter& other) const { return (groups & other.mask) != 0 && (other.groups & mask) != 0; }
    };
    std::span<const Box> boxes; ///< no_box where there is no body
    std::span<const Filter> filters;

    bool is_pair(BodySlot a, BodySlot b) const {
        return boxes[a].touches(boxes[b]) && (filters.empty() || filters[a].lets_meet(filters[b]));
    }
};

/// Finds the pairs of boxes that touch by a tree without topology: boxes lie along a space-filling curve, sixteen in a
/// row make a node, sixteen nodes one of the next level. Any order is right; a curve is sought anew once the order of
/// an earlier step has become slow, or many boxes have moved. On all threads; no result depends on their number.
class BroadPhase {
public:
    /// pairs: becomes all of those whose boxes touch, and which no filter keeps apart, sorted.
    void find(Executor& executor, const BroadPhaseInput& input, std::vector<SlotPair>& pairs);
    /// The same after a find() or update() of which `pairs` are what they became, when only the boxes in the slots of
    /// `changed`, each once, are others since. Returns whether the pairs are.
    bool update(Executor& executor, const BroadPhaseInput& input, std::span<const BodySlot> changed,
                std::vector<SlotPair>& pairs);
    /// Frees memory that the next call makes anew.
    void trim();

private:
    static constexpr std::uint32_t width = 16;
    using Corner = std::array<float, 3>;
    /// Sixteen boxes, rounded outward; lanes without one touch nothing.
    struct Node {
        float low[3][width], high[3][width];
        void set(std::uint32_t lane, const Corner& from, const Corner& to);
    };
    /// By one thread.
    struct Found {
        std::vector<SlotPair> pairs;
        std::uint64_t tests = 0; ///< of nodes
    };

    void sort_boxes(std::span<const Box> boxes);
    void fill_tree(Executor& executor, std::span<const Box> boxes);
    void refit(std::span<const Box> boxes, std::span<const BodySlot> changed);
    template <class Work>
    void run(Executor& executor, std::size_t count, Work&& work);
    void meet(Found& found, const BroadPhaseInput& input, std::uint32_t node) const;
    void descend(Found& found, const BroadPhaseInput& input, std::uint32_t node, const Corner& low, const Corner& high,
                 std::size_t level, std::uint32_t at) const;
    void test(Found& found, const BroadPhaseInput& input, std::uint32_t node, std::uint32_t other) const;
    void query(Found& found, const BroadPhaseInput& input, BodySlot body, std::size_t level, std::uint32_t at) const;
    void gather(Executor& executor, std::size_t slots, std::vector<SlotPair>& pairs);
    bool replace(std::vector<SlotPair>& pairs);
    bool is_changed(const SlotPair& pair) const { return (is_changed_[pair.first] | is_changed_[pair.second]) != 0; }
    static std::uint32_t touching(const Node& node, const Corner& low, const Corner& high);
    static void bounds_of(const Node& node, Corner& low, Corner& high);

    std::vector<BodySlot> order_;       ///< along the curve
    std::vector<std::uint32_t> places_; ///< by slot: its place in the order
    std::vector<std::pair<std::uint64_t, BodySlot>> keys_;
    std::vector<std::vector<Node>> levels_; ///< the lowest holds boxes
    std::vector<Found> found_;
    std::vector<std::size_t> firsts_;                 ///< by slot: its first pair
    std::uint64_t tests_ = 0, tests_when_sorted_ = 0; ///< of the last find(); of the one that sorted
    std::uint64_t changes_ = 0;                       ///< since then, by update()
    std::vector<char> is_changed_;                    ///< by slot
    std::vector<std::uint32_t> touched_;              ///< nodes
    std::vector<SlotPair> gone_, come_, next_;
};

} // namespace raycontact
