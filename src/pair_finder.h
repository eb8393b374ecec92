// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "box_changes.h"
#include "broadphase/broad_phase.h"
#include "narrow_phase.h"
#include "world_boxes.h"

#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// Finds the pairs of a scene's bodies whose boxes touch, and which no filter keeps apart: on the host, or on the
/// device of the first part, whichever has less to do.
class PairFinder {
public:
    /// For bodies in slots below this; a new one meets all.
    void make_room(std::size_t slots);
    /// A body that is new, gone or elsewhere, or expected elsewhere.
    void mark(BodySlot body) noexcept;
    /// Any body may be.
    void forget() noexcept;
    /// Frees the memory of slots from this on, which have no body.
    void cut(std::size_t slots) noexcept;
    /// Frees memory that the next find() makes anew.
    void trim();

    void add_shape(const Shape& shape) { world_.add_shape(shape); }
    /// A body is gone, its pairs are closed.
    void remove_body(BodySlot body, const Shape& shape);
    void set_filter(BodySlot body, const BroadPhaseInput::Filter& filter);
    const BroadPhaseInput::Filter& filter(BodySlot body) const { return filters_[body]; }

    /// next: where bodies are expected, by slot; empty: nowhere.
    void find(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next, OpenPairs& pairs);
    /// Somebody else has set, or will set, the pairs.
    void drop_list() noexcept;

    /// The boxes as they are, for queries between two steps. Not on two threads at once.
    const WorldBoxes& boxes(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next);

private:
    void find_on_host(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next, bool stood,
                      OpenPairs& pairs);
    bool find_on_device(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                        OpenPairs& pairs);

    std::vector<BroadPhaseInput::Filter> filters_; ///< by slot
    WorldBoxes world_;
    BoxChanges box_changes_;
    BroadPhase broad_phase_;
    SlotChanges unlisted_;         ///< bodies whose box or filter may be another than when the pairs were found
    SlotChanges::Seen listed_ = 0; ///< when that was; 0: the pairs are others
    float listed_reach_ = 0;       ///< WorldBoxes::reach() then
    std::optional<std::size_t> listing_part_; ///< the part whose device found the pairs
    std::vector<BodySlot> others_;            ///< of find_on_host()
};

} // namespace raycontact
