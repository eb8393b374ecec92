// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/world_box.h"
#include "executor/executor.h"
#include "slot_pair.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// A tree without topology over the boxes of bodies: they lie along a space-filling curve, sixteen in a row make a
/// node, sixteen nodes one of the next level. Any order is right; a curve is sought anew when many boxes have moved, or
/// when it is asked for.
class BoxTree {
public:
    static constexpr std::uint32_t width = 16;
    using Corner = std::array<float, 3>;
    /// Sixteen boxes, rounded outward; lanes without one touch nothing.
    struct Node {
        float low[3][width], high[3][width];
        void set(std::uint32_t lane, const Corner& from, const Corner& to);
        /// Of all.
        void bounds(Corner& from, Corner& to) const;
        /// A bit for each lane.
        std::uint32_t touching(const Corner& from, const Corner& to) const;
    };
    static void round_out(const Box& box, Corner& low, Corner& high);

    /// boxes: by slot, no_box where there is no body.
    void build(Executor& executor, std::span<const Box> boxes);
    /// The same after a build() or update(), when only the boxes in the slots of `changed`, each once, are others
    /// since.
    void update(Executor& executor, std::span<const Box> boxes, std::span<const BodySlot> changed);
    /// The next build() or update() seeks a new curve.
    void sort_next() { sorts_next_ = true; }
    /// How often a curve was sought.
    std::uint64_t sorts() const { return sorts_; }

    /// The lowest level holds boxes; the last is one node. None: no boxes.
    std::size_t levels() const { return levels_.size(); }
    std::span<const Node> level(std::size_t number) const { return levels_[number]; }
    /// At so many lanes of the lowest level.
    BodySlot body(std::size_t place) const { return order_[place]; }
    std::size_t size() const { return order_.size(); }

    /// Calls visit(slot) for the bodies whose boxes are not farther than farthest(), which visits may lessen; near ones
    /// mostly come first. away(box): how far it is, infinite for those that do not count; of boxes around many, not
    /// more than of any of these.
    template <class Away, class Farthest, class Visit>
    void visit(Away&& away, Farthest&& farthest, Visit&& visit) const {
        if (!levels_.empty()) descend(away, farthest, visit, levels_.size() - 1, 0);
    }

private:
    template <class Away, class Farthest, class Visit>
    void descend(Away& away, Farthest& farthest, Visit& visit, std::size_t level, std::uint32_t at) const {
        const Node& node = levels_[level][at];
        std::array<std::pair<double, std::uint32_t>, width> near;
        std::size_t count = 0;
        for (std::uint32_t k = 0; k < width; ++k) {
            const Box box{{node.low[0][k], node.low[1][k], node.low[2][k]},
                          {node.high[0][k], node.high[1][k], node.high[2][k]}};
            if (!(box.low.x <= box.high.x)) continue;
            const double metres = away(box);
            if (metres <= farthest() && metres < infinitely_far) near[count++] = {metres, k};
        }
        std::sort(near.begin(), near.begin() + std::ptrdiff_t(count));
        for (std::size_t i = 0; i < count; ++i) {
            if (near[i].first > farthest()) return;
            const std::uint32_t child = width * at + near[i].second;
            if (level > 0)
                descend(away, farthest, visit, level - 1, child);
            else
                visit(order_[child]);
        }
    }
    void sort(std::span<const Box> boxes);
    void fill(Executor& executor, std::span<const Box> boxes);
    void refit(std::span<const Box> boxes, std::span<const BodySlot> changed);

    std::vector<BodySlot> order_;       ///< along the curve
    std::vector<std::uint32_t> places_; ///< by slot: its place in the order
    std::vector<std::pair<std::uint64_t, BodySlot>> keys_;
    std::vector<std::vector<Node>> levels_;
    std::vector<std::uint32_t> touched_;    ///< nodes
    std::uint64_t sorts_ = 0, changes_ = 0; ///< changes_: boxes, since the last sort
    bool sorts_next_ = false;
};

} // namespace raycontact
