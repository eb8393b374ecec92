// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/pair_slots.h"
#include "pairs/pair_sorter.h"

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

namespace raycontact {

/// The open pairs of a scene, each in a list of either body. What a step tells of them grows with the pairs that open,
/// close, or have a body that moved.
class OpenPairs {
public:
    /// Says whether two bodies may be a pair.
    using Admits = std::function<bool(const SlotPair&)>;
    /// Asked about each pair of set_all(), set_of() and apply() as it would open, and about all in the next set_all().
    void set_gate(Admits admits);
    /// The gate has refused it, and it was not closed since.
    bool is_refused(const SlotPair& pair) const { return std::ranges::binary_search(refused_, pair); }

    /// `pairs`, sorted, each once, become all that are open. given: whatever the gate says.
    void set_all(Executor& executor, std::span<const SlotPair> pairs, bool given = false);
    /// Of the pairs with a body of `bodies`, each once, `pairs` become those that are open. is_in: whether a body is
    /// one of them, by slot.
    void set_of(Executor& executor, std::span<const BodySlot> bodies, std::span<const char> is_in,
                std::span<const SlotPair> pairs);
    /// Each sorted. Of `closed` those may be closed already that have a body that is gone.
    void apply(std::span<const SlotPair> opened, std::span<const SlotPair> closed);
    /// Closes all pairs of a body.
    void close_all_of(BodySlot body) noexcept;
    /// Closes all, and frees their memory.
    void clear() noexcept;
    /// Gives them the lowest slots, and memory back, where few of many slots are in use: then true, and what keeps
    /// something of pairs begins anew.
    bool compact(Executor& executor);

    const PairSlots& slots() const { return slots_; }
    /// All, in order. Not on two threads at once.
    const PairList& all(Executor& executor);
    /// Those that opened since the last step, and those of some bodies, in order.
    void list_of(Executor& executor, const SlotChanges& bodies, PairList& list);
    /// Those of some bodies, in order. is_in: whether a body is one of them, by slot.
    void list_of(Executor& executor, std::span<const BodySlot> bodies, std::span<const char> is_in, PairList& list);
    /// Those that closed since the last step, sorted; of what may have closed before, all.
    std::span<const SlotPair> closed();
    /// How many were open in the last step, too.
    std::size_t count_kept() const;
    bool have_changed() const { return !slots_.changes().list().empty(); }
    void step_done() noexcept;
    /// What keeps something of pairs must begin anew.
    void forget() noexcept;
    void trim();

private:
    static constexpr std::uint32_t none = NONE;
    using Edge = std::uint32_t; ///< 2 x slot, + 1 in the list of the second body
    struct Link {
        Edge next = none, previous = none;
    };
    /// Of pairs in a row: what stays, and places of what comes and goes.
    struct Run {
        std::size_t old, now, count;
    };
    struct Slice {
        std::vector<Run> kept;
        std::vector<std::size_t> opened, closed;
    };
    BodySlot body_of(Edge edge) const {
        const kernels::PairBodies& pair = slots_.bodies()[edge / 2];
        return edge % 2 == 0 ? pair.first : pair.second;
    }
    std::uint32_t open(const SlotPair& pair);
    void close(std::uint32_t slot) noexcept;
    void unlink(Edge edge) noexcept;
    std::uint32_t slot_of(const SlotPair& pair) const;
    template <class BodyAt, class IsIn>
    void find(Executor& executor, std::size_t count, BodyAt&& body_at, IsIn&& is_in);
    void list_found(Executor& executor, PairList& list);
    template <class Concerns>
    std::span<const SlotPair> admitted(std::span<const SlotPair> old, std::span<const SlotPair> now,
                                       Concerns&& concerns);
    bool replace(Executor& executor, PairList& list, std::span<const SlotPair> now);
    void compare(const PairList& old, std::span<const SlotPair> now, std::size_t slice);

    PairSlots slots_;
    std::vector<Edge> heads_; ///< by body
    std::vector<Link> links_; ///< by edge
    std::vector<SlotPair> closed_;
    Admits admits_; ///< empty: no gate
    bool asks_all_ = false;
    std::vector<SlotPair> refused_, still_refused_, admitted_; ///< sorted

    PairList all_; ///< if it is up to date
    bool has_all_ = true;
    PairList of_bodies_; ///< of set_of()
    std::vector<Slice> slices_;
    std::vector<std::vector<OpenPair>> found_; ///< by some bodies, and one more
    std::vector<std::span<const OpenPair>> lists_;
    std::vector<OpenPair> sorted_;
    PairSorter<OpenPair> sorter_;
    std::vector<std::uint32_t> next_slots_;
};

} // namespace raycontact
