// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/world_box.h"
#include "executor/executor.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Finds the pairs of boxes that touch by a tree without topology: boxes lie along a space-filling curve, sixteen in a
/// row make a node, sixteen nodes one of the next level. Any order is right; a curve is sought anew once the order of
/// an earlier step has become slow. On all threads; no result depends on their number.
class BroadPhase {
public:
    /// pairs: becomes those whose boxes touch, sorted. Each body has one box; the order of boxes does not matter.
    void find(Executor& executor, std::span<const WorldBox> boxes, std::vector<SlotPair>& pairs);
    /// Frees memory that the next find() makes anew.
    void trim();

private:
    static constexpr std::uint32_t width = 16;
    using Corner = std::array<float, 3>;
    /// Sixteen boxes, rounded outward; lanes without one touch nothing.
    struct Node {
        float low[3][width], high[3][width];
    };
    /// Of some nodes of the lowest level, found by one thread.
    struct Found {
        std::vector<SlotPair> pairs;
        std::uint64_t tests = 0; ///< of nodes
    };

    void sort_boxes(std::span<const WorldBox> boxes);
    void fill_tree(Executor& executor, std::span<const WorldBox> boxes);
    void meet(Found& found, std::span<const WorldBox> boxes, std::uint32_t node) const;
    void descend(Found& found, std::span<const WorldBox> boxes, std::uint32_t node, const Corner& low,
                 const Corner& high, std::size_t level, std::uint32_t at) const;
    void test(Found& found, std::span<const WorldBox> boxes, std::uint32_t node, std::uint32_t other) const;
    void gather(Executor& executor, std::span<const WorldBox> boxes, std::vector<SlotPair>& pairs);
    static std::uint32_t touching(const Node& node, const Corner& low, const Corner& high);
    static void bounds_of(const Node& node, Corner& low, Corner& high);

    std::vector<std::uint32_t> order_; ///< of the boxes along the curve
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;
    std::vector<std::vector<Node>> levels_; ///< the lowest holds boxes
    std::vector<Found> found_;
    std::vector<std::size_t> firsts_;                 ///< by body: its first pair
    std::uint64_t tests_ = 0, tests_when_sorted_ = 0; ///< of the last step; of the step that sorted
};

} // namespace raycontact
