// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"
#include "slot_changes.h"

#include <cstddef>
#include <span>
#include <vector>

namespace raycontact {

/// Where each body is expected at the next step: where the caller said, else as far from its pose as that is from the
/// one of the last step; where it is if that is farther than its own size, as when it was put elsewhere.
class NextPoses {
public:
    /// Holds for one step.
    void set(BodySlot body, std::uint32_t generation, const Pose& pose);
    /// First in a step. Of the body frames, by slot; those of slots without a body mean nothing. Marks the bodies that
    /// are expected elsewhere than at the last step.
    std::span<const Pose> update(Executor& executor, std::span<const PlacedBody> bodies, SlotChanges& moved);
    /// Last in a step.
    void step_done(Executor& executor, std::span<const PlacedBody> bodies);
    void forget();
    void save(std::vector<std::byte>& bytes) const;
    void load(std::span<const std::byte>& bytes);

private:
    struct Known {
        Pose pose;
        std::uint32_t generation = 0; ///< of the body that it is of
        bool there = false;
        bool is_of(const PlacedBody& body) const { return there && generation == body.generation; }
    };
    static bool goes_on(const Known& last, const PlacedBody& body);

    std::vector<Known> given_, last_;
    std::vector<Pose> next_;
    std::vector<char> changed_; ///< by slot: next_ has, in this step
};

} // namespace raycontact
