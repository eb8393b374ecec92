// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/broad_phase.h"
#include "broadphase/device_broad_phase.h"
#include "free_all.h"
#include "world_boxes.h"

#include <span>
#include <vector>

namespace raycontact {

/// What the broad phase of a device has to be told of a scene's bodies.
class BoxChanges {
public:
    /// What makes a box another one, or its filter.
    void make_room(std::size_t slots) { moved_.make_room(slots); }
    void mark(BodySlot body) noexcept { moved_.mark(body); }
    void forget() noexcept { moved_.forget(); }
    void cut(std::size_t slots) noexcept { moved_.cut(slots); }
    /// Frees memory; all is to be told anew then.
    void trim() {
        free_all(listed_, is_other_, places_, extents_, others_);
        seen_ = 0;
    }

    /// Since the last call, where a device still knows so many slots as it was told of then; else of all. next: as
    /// WorldBoxes::update() has it.
    DeviceBroadPhase::Changes list(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                                   std::span<const BroadPhaseInput::Filter> filters, WorldBoxes& world,
                                   const Settings& settings, std::size_t known);

private:
    SlotChanges moved_;
    SlotChanges::Seen seen_ = 0;
    float reach_ = -1;             ///< WorldBoxes::reach() in the last call
    std::vector<BodySlot> listed_; ///< those that moved
    std::vector<char> is_other_;   ///< of those: the extent is
    std::vector<kernels::BodyPlace> places_;
    std::vector<kernels::BodyExtent> extents_, others_; ///< as told, by slot; those that changed
};

} // namespace raycontact
