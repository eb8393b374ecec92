// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// Which slots of bodies, or of pairs, have changed since the last step: a body is new, gone, elsewhere or expected
/// elsewhere at the next step; a pair is open or closed. What keeps something by slot asks each step for these alone.
class SlotChanges {
public:
    using Slot = std::uint32_t;
    /// What a user has seen: a step's number.
    using Seen = std::uint64_t;

    /// For slots below this, so that mark() cannot fail.
    void make_room(std::size_t slots) {
        if (marked_.size() >= slots) return;
        list_.resize(slots);
        marked_.resize(slots, 0);
    }
    /// Frees the memory of slots from this on, which are empty; any other may have changed then.
    void cut(std::size_t slots) noexcept {
        forget();
        marked_.resize(std::min(slots, marked_.size()));
        list_.resize(marked_.size());
        marked_.shrink_to_fit();
        list_.shrink_to_fit();
    }
    void mark(Slot slot) noexcept {
        if (std::exchange(marked_[slot], 1) == 0) list_[count_++] = slot;
    }
    bool is_marked(Slot slot) const { return marked_[slot] != 0; }
    /// In the order of their marks, each once.
    std::span<const Slot> list() const { return std::span(list_).first(count_); }

    /// The step that is being made.
    Seen now() const { return step_; }
    /// Whether the step that was seen is the last one.
    bool is_next(Seen seen) const { return seen + 1 == step_; }

    /// Returns the step that is done, as one that saw all of it has it.
    Seen step_done() noexcept {
        next_step(1);
        return step_ - 1;
    }
    /// Any slot may have changed, as after a step that failed half-way.
    void forget() noexcept { next_step(2); }

    /// Calls work(slot) for those that changed since the step that was seen; for all below `slots` if that is not the
    /// last one. Returns whether they were all. Marked slots from `slots` on are empty.
    template <class Work>
    bool each_since(Seen& seen, std::size_t slots, Work&& work) const {
        return each_since(seen, slots, work, [](std::size_t count, auto&& one) {
            for (std::uint32_t i = 0; i < count; ++i) one(i);
        });
    }
    /// The same on all threads.
    template <class Work>
    bool each_since(Seen& seen, Executor& executor, std::size_t slots, Work&& work) const {
        return each_since(seen, slots, work, [&](std::size_t count, auto&& one) { executor.each(count, 512, one); });
    }

private:
    template <class Work, class Run>
    bool each_since(Seen& seen, std::size_t slots, Work&& work, Run&& run) const {
        const Seen last = seen;
        seen = step_;
        if (last == step_) return false;
        if (last + 1 != step_) {
            run(slots, work);
            return true;
        }
        run(count_, [&](std::uint32_t i) {
            if (list_[i] < slots) work(list_[i]);
        });
        return false;
    }

    void next_step(Seen by) noexcept {
        for (const Slot slot : list()) marked_[slot] = 0;
        count_ = 0;
        step_ += by;
    }

    std::vector<Slot> list_; ///< in the order of their marks: the first count_; with room for all slots
    std::size_t count_ = 0;
    std::vector<char> marked_; ///< by slot
    Seen step_ = 2;            ///< a user that has seen none has 0
};

} // namespace raycontact
