// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/box_tree.h"
#include "pairs/directed_pairs.h"
#include "slot_changes.h"

#include <raycontact/settings.h>

#include <span>
#include <vector>

namespace raycontact {

/// The boxes of a scene's bodies in the world, and a tree over them, for the broad phase and for queries.
class WorldBoxes {
public:
    /// What makes a box another one: a body that is new, gone or elsewhere, a shape, settings.
    void make_room(std::size_t slots) { moved_.make_room(slots); }
    void mark(BodySlot body) noexcept { moved_.mark(body); }
    void add_shape(const Shape& shape);
    void remove_shape(const Shape& shape);
    void forget() noexcept { moved_.forget(); }
    void cut(std::size_t slots) noexcept { moved_.cut(slots); }

    /// next: where bodies are expected, whose boxes then hold the way there; empty: nowhere. Both by slot.
    void update(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                const Settings& settings);
    /// The longest ray of all bodies, metres.
    float reach(std::span<const PlacedBody> bodies) {
        if (!reach_known_) measure_reach(bodies);
        return reach_;
    }
    /// By how much a body's box is widened on every side, metres; after reach(). looks_ahead: the body is expected
    /// somewhere.
    double growth(const PlacedBody& body, bool looks_ahead, const Settings& settings) const;
    /// Whether an update() would change nothing.
    bool is_up_to_date() const { return reach_known_ && moved_.is_next(seen_) && moved_.list().empty(); }

    /// By slot, and some more; no_box where there is no body.
    std::span<const Box> boxes() const { return boxes_; }
    const BoxTree& tree() const { return tree_; }
    BoxTree& tree() { return tree_; }
    /// How far a vertex as its file has it can be from the box of its shape, metres.
    double rounding() const { return rounding_; }
    void trim() { boxes_.shrink_to_fit(); }

private:
    void measure_reach(std::span<const PlacedBody> bodies);
    Box box_of(const PlacedBody& body, const Pose* next, const Settings& settings) const;
    void resize(std::size_t slots);
    void remake(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                const Settings& settings);

    SlotChanges moved_; ///< since the last update()
    SlotChanges::Seen seen_ = 0;
    float reach_ = 0; ///< how far beyond the box of an open mesh a vertex can lie and still reach it, metres
    double rounding_ = 0;
    bool reach_known_ = true;
    std::vector<Box> boxes_;
    BoxTree tree_;
    std::vector<char> is_other_;   ///< by slot
    std::vector<BodySlot> others_; ///< than before the last update()
};

} // namespace raycontact
