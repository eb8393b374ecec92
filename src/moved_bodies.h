// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "slot_pair.h"

#include <algorithm>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

namespace raycontact {

/// Which bodies are new, gone or elsewhere since the last step, or expected elsewhere at the next one. What keeps
/// something of each body asks each step for these alone.
class MovedBodies {
public:
    /// What a user has seen: a step's number.
    using Seen = std::uint64_t;

    /// For bodies in slots below this, so that mark() cannot fail.
    void make_room(std::size_t slots) {
        if (marked_.size() < slots) marked_.resize(slots, 0);
        if (list_.capacity() < slots) list_.reserve(marked_.capacity());
    }
    /// Frees the memory of slots from this on, which have no body; any other may be elsewhere then.
    void cut(std::size_t slots) noexcept {
        forget();
        marked_.resize(std::min(slots, marked_.size()));
        marked_.shrink_to_fit();
        list_.shrink_to_fit();
        try {
            list_.reserve(marked_.size());
        } catch (const std::bad_alloc&) {
        }
    }
    void mark(BodySlot body) noexcept {
        if (marked_[body] != 0) return;
        if (list_.size() == list_.capacity()) return forget(); // after a cut that lacked memory
        marked_[body] = 1;
        list_.push_back(body);
    }
    bool is_marked(BodySlot body) const { return marked_[body] != 0; }
    std::span<const BodySlot> list() const { return list_; }

    /// The step that is being made.
    Seen now() const { return step_; }
    /// Whether the step that was seen is the last one.
    bool is_next(Seen seen) const { return seen + 1 == step_; }

    /// Returns the step that is done, as one that saw all of it has it.
    Seen step_done() noexcept {
        next_step(1);
        return step_ - 1;
    }
    /// Any body may be elsewhere, as after a step that failed half-way.
    void forget() noexcept { next_step(2); }

    /// Calls work(slot) for the bodies that moved since the step that was seen; for all below `slots` if that is not
    /// the last one. Returns whether they were all. Marked slots from `slots` on have no body any more.
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
        run(list_.size(), [&](std::uint32_t i) {
            if (list_[i] < slots) work(list_[i]);
        });
        return false;
    }

    void next_step(Seen by) noexcept {
        for (const BodySlot body : list_) marked_[body] = 0;
        list_.clear();
        step_ += by;
    }

    std::vector<BodySlot> list_; ///< in the order of their marks
    std::vector<char> marked_;   ///< by slot
    Seen step_ = 2;              ///< a user that has seen none has 0
};

} // namespace raycontact
