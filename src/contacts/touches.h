// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/contact_store.h"
#include "executor/executor.h"
#include "pairs/directed_pairs.h"
#include "slot_changes.h"

#include <raycontact/scene.h>

#include <functional>
#include <span>
#include <vector>

namespace raycontact {

/// Which pairs of bodies touch, from step to step (Scene::touching()).
class Touches {
public:
    /// A step that found contacts.
    struct Step {
        std::span<const PlacedBody> bodies;
        std::span<const Pose> next;                         ///< where bodies are expected, by slot; empty: nowhere
        const SlotChanges& moved;                           ///< bodies
        const ContactStore &contacts, &sensed;              ///< sensed: of pairs with a sensor
        ContactStore::Asked asked;                          ///< whose contacts may be others
        std::function<bool(const SlotPair&)> is_kept_apart; ///< by a filter
    };
    void update(Executor& executor, const Step& step);
    /// Of a step in which nothing is new.
    void rest() noexcept;
    /// Puts back what all() was; nothing is told of it.
    void restore(std::vector<Touch> touches);

    std::span<const Touch> all() const { return all_; } ///< by pair
    std::span<const Touch> begun() const { return begun_; }
    std::span<const Touch> ended() const { return ended_; }

private:
    /// A pair that was asked about, or touches.
    struct Candidate {
        SlotPair pair;
        Touch deepest;            ///< its deepest contact
        bool has_contact = false; ///< so there is one
        bool touches = false;
        std::size_t old = none; ///< its place in all_, if it touched in the last step, too
        bool stays = false;     ///< and does so still
        Touch kept;             ///< then
    };
    static constexpr std::size_t none = ~std::size_t{0};
    void list_all(Executor& executor, const Step& step);
    void list_asked(Executor& executor, const Step& step);
    void replace();

    SlotChanges::Seen seen_ = 0; ///< of bodies: the last step
    std::vector<Touch> all_, begun_, ended_, next_;
    std::vector<char> hangs_, next_hangs_; ///< of all_: it has no contact
    std::vector<SlotPair> pairs_;
    std::vector<std::vector<Candidate>> slices_;
    std::vector<Candidate> candidates_; ///< by pair
};

} // namespace raycontact
